//! Broad phase: which point-triangle and edge-edge pairs may come near each other during a motion.
//!
//! Two triangles are compared when their boxes, swept along the motion, come within the search distance, or, where all points move by
//! the same fraction of their displacements, do so at some moment (`mesh::static_bvh`). Every point and every edge belongs to one of the
//! triangles around it, and a pair of triangles compares only what belongs to it: its points with the other triangle, its edges with the
//! other's edges. So each pair of primitives is tested exactly once, and nothing has to be deduplicated. A pair whose boxes are near is
//! kept if its distance at the start is at most the search distance plus the displacement by which the two can approach each other.
//!
//! Pairs with a common point never count; points in no triangle are ignored. The lists are sorted and depend neither on earlier queries nor
//! on the number of threads. A candidate is not yet a contact: the energies decide by the actual distance. A motion that is not finite
//! counts as none (`contact::step_bounds` makes none); a start that is not finite takes the triangles around it out of the search, so
//! whoever makes positions checks them.

mod candidate_finder;
mod candidates;
mod pair_filter;
mod primitive_pair;
mod primitives;
mod search_query;
#[cfg(test)]
mod tests;
mod verlet_list;

pub use candidate_finder::{CandidateFinder, MovingSubset};
pub use candidates::Candidates;
pub use primitive_pair::{PairKind, PrimitivePair};
pub use search_query::SearchQuery;
