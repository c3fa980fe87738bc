//! Signs by which a file of USD is known, in every build.

/// First bytes of a layer as text.
pub(crate) const TEXT_MAGIC: &[u8] = b"#usda";
/// First bytes of a binary layer.
pub(crate) const BINARY_MAGIC: &[u8] = b"PXR-USDC";

/// Extensions of USD files, in lower case.
pub const FILE_EXTENSIONS: [&str; 4] = ["usd", "usda", "usdc", "usdz"];

/// Returns whether `bytes` begin as a file of USD does: a layer, or a package of layers.
pub fn is_usd(bytes: &[u8]) -> bool {
    is_layer(bytes) || is_package(bytes)
}

/// Returns whether `bytes` begin as a layer of USD does.
pub(crate) fn is_layer(bytes: &[u8]) -> bool {
    bytes.starts_with(BINARY_MAGIC) || bytes.starts_with(TEXT_MAGIC)
}

/// Returns whether `bytes` begin as a ZIP archive does.
pub(crate) fn is_package(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}
