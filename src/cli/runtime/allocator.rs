//! Settings of the C library's memory allocator.

/// Limits glibc to a single arena and returns large blocks to the system when they are freed. By default each thread
/// has an arena of its own, which keeps freed memory that other threads cannot use: a bake of 13,863 points needs a
/// tenth less memory with one arena. Must be called before other threads start; does nothing on other platforms.
pub(in crate::cli) fn use_single_arena() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        // Blocks from this size on are mapped separately, and unmapped when they are freed [bytes].
        const MMAP_THRESHOLD: libc::c_int = 4 << 20;
        // Free memory at the end of the heap that is not returned [bytes].
        const TRIM_THRESHOLD: libc::c_int = 8 << 20;
        let settings = [
            (libc::M_ARENA_MAX, 1),
            (libc::M_MMAP_THRESHOLD, MMAP_THRESHOLD),
            (libc::M_TRIM_THRESHOLD, TRIM_THRESHOLD),
        ];
        for (name, value) in settings {
            // Safe: it sets a number. A refusal costs memory only.
            unsafe { libc::mallopt(name, value) };
        }
    }
}
