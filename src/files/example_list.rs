//! Garments that are part of the program: files of `garments/`, which the tool writes as examples and charts bake.

/// T-shirt of 1,999 points, as .glb.
pub const TSHIRT_DRAFT: &[u8] = include_bytes!("../../garments/tshirt-draft.glb");
/// T-shirt of 13,863 points, as .glb.
pub const TSHIRT: &[u8] = include_bytes!("../../garments/tshirt.glb");
/// Square of 300 mm, as .glb.
pub const HANDKERCHIEF: &[u8] = include_bytes!("../../garments/handkerchief.glb");
/// Sleeve on an arm with an elbow, as .glb: nodes `sleeve` and `arm`.
pub const SLEEVE: &[u8] = include_bytes!("../../garments/sleeve.glb");
