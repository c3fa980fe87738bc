//! Where a garment lies and where its folds go: the flat layout of a worn shape, the order of its layers, maps of folds and
//! rolls, and the fold lines drawn through every layer before the run.

pub(crate) mod draw_lines;
pub(crate) mod flat_layout;
pub(crate) mod fold_layout;
pub(crate) mod fold_map;
pub(crate) mod height_field;
pub(crate) mod layer_heights;
pub(crate) mod layer_order;
pub(crate) mod layout_sides;
pub(crate) mod line_layout;
pub(crate) mod overlap_order;
pub(crate) mod panel;
pub(crate) mod plane_map;
pub(crate) mod roll_map;
