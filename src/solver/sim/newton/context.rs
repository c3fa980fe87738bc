//! The arguments common to all parts of a solve.

use crate::contact::Contact;
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::workspace::Workspace;

/// Contact, buffers and figures of a solve in progress.
pub(super) struct SolveContext<'a> {
    pub contact: &'a mut Contact,
    pub work: &'a mut Workspace,
    pub report: &'a mut NewtonReport,
    /// Whether a local solve has used up its rounds.
    pub local_gave_up: bool,
}

impl<'a> SolveContext<'a> {
    /// The context of a solve that begins.
    pub fn new(contact: &'a mut Contact, work: &'a mut Workspace, report: &'a mut NewtonReport) -> Self {
        Self { contact, work, report, local_gave_up: false }
    }
}
