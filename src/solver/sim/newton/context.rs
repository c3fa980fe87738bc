//! The arguments common to all parts of a solve.

use crate::contact::Contact;
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::workspace::Workspace;

/// Contact, buffers and figures of a solve in progress.
pub(super) struct SolveContext<'a> {
    pub contact: &'a mut Contact,
    pub work: &'a mut Workspace,
    pub report: &'a mut NewtonReport,
}
