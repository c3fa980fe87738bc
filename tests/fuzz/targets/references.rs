#![no_main]
#[allow(dead_code)]
#[path = "../feed.rs"]
mod feed;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = feed::mesh_with_file(bytes);
});
