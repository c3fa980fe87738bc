//! Prefix sums of compressed row storage.

/// Replaces counts by their exclusive prefix sums, the first index of each, and returns the total.
pub(super) fn prefix_sum(count: &mut [u32]) -> u32 {
    let mut total = 0;
    for c in count {
        total += std::mem::replace(c, total);
    }
    total
}
