//! Hems and seams: strips where the cloth is more than one layer, as it is turned over and sewn at borders and between panels.

use crate::garment::Garment;
use crease_geometry::mesh::{INVALID, PointIndex, edge_distances, triangle};

/// Per triangle of `garment`: fraction of its area within `width` [m] of an open border, measured along edges, from 0 to 1; times its
/// sewing mask.
pub fn hem_fractions(garment: &Garment, width: f64) -> Vec<f64> {
    let topology = &garment.topology;
    strip_fractions(garment, width, |e| topology.edge_triangles[e][1] == INVALID)
}

/// Per triangle of `garment`: fraction of its area within `width` [m] of a seam, measured along edges, from 0 to 1. Seams are the edges
/// between two panels and those of more than two triangles. The fraction counts times the sewing mask.
pub fn seam_fractions(garment: &Garment, width: f64) -> Vec<f64> {
    let topology = &garment.topology;
    let panel = |f: u32| garment.triangle_panel[f as usize];
    strip_fractions(garment, width, |e| {
        let [a, b] = topology.edge_triangles[e];
        b != INVALID && (panel(a) != panel(b) || topology.edge_valence[e] > 2)
    })
}

/// Per triangle: fraction of its area within `width` [m] of the edges that `is_middle` flags, from 0 to 1, times the mean sewing mask of
/// its corners.
fn strip_fractions(garment: &Garment, width: f64, is_middle: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut middle = vec![false; garment.points.len()];
    for (_, ends) in garment.topology.edges.iter().enumerate().filter(|(e, _)| is_middle(*e)) {
        ends.iter().for_each(|p| middle[p.at()] = true);
    }
    let distance = edge_distances(&garment.points, &garment.topology, &middle, width);
    let fraction = |t: &[PointIndex; 3]| {
        let mut d = t.map(|p| distance[p.at()]);
        d.sort_unstable_by(f64::total_cmp);
        let x = triangle::corners(&garment.points, t);
        let span = (d[2] - d[0]).min(triangle::longest_side(&x)).max(f64::MIN_POSITIVE);
        let mask = t.iter().map(|p| garment.sewing_mask[p.at()]).sum::<f64>() / 3.0;
        mask * ((width - d[0]) / span).clamp(0.0, 1.0)
    };
    garment.triangles.iter().map(fraction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 0.2 m with edges of 10 mm, two panels wide.
    fn sheet() -> Garment {
        let sheet = Garment::sheet([0.2; 2], [20; 2]).expect("is a sheet");
        let is_left = |t: &[PointIndex; 3]| t.iter().all(|p| sheet.points[p.at()].x < 0.1 + 1e-9);
        let triangle_panel = sheet.triangles.iter().map(|t| u32::from(!is_left(t))).collect();
        Garment { triangle_panel, ..sheet }
    }

    #[test]
    fn a_strip_along_the_border_is_hemmed() {
        let fractions = hem_fractions(&sheet(), 0.02);
        // A strip of 0.02 m along all sides of 0.2 m: 1 - 0.8² of the area.
        let hemmed: f64 = fractions.iter().sum::<f64>() / fractions.len() as f64;
        assert!((hemmed - 0.36).abs() < 1e-9, "{hemmed}");
    }

    #[test]
    fn a_strip_on_both_sides_of_the_edge_between_panels_is_double() {
        let fractions = seam_fractions(&sheet(), 0.01);
        // Two strips of 0.01 m in a sheet 0.2 m wide.
        let double: f64 = fractions.iter().sum::<f64>() / fractions.len() as f64;
        assert!((double - 0.1).abs() < 1e-9, "{double}");
        let one_panel = Garment { triangle_panel: vec![0; fractions.len()], ..sheet() };
        assert!(seam_fractions(&one_panel, 0.01).iter().all(|f| *f == 0.0));
    }

    #[test]
    fn where_the_mask_is_0_nothing_is_sewn() {
        let mut garment = sheet();
        let is_left: Vec<bool> = garment.points.iter().map(|p| p.x < 0.1 + 1e-9).collect();
        garment.sewing_mask = is_left.iter().map(|is_left| f64::from(u8::from(!is_left))).collect();
        let (whole, masked) = (hem_fractions(&sheet(), 0.02), hem_fractions(&garment, 0.02));
        for ((t, whole), masked) in garment.triangles.iter().zip(whole).zip(masked) {
            let left = t.iter().filter(|p| is_left[p.at()]).count();
            assert!((masked - whole * (3 - left) as f64 / 3.0).abs() < 1e-12, "{left} {whole} {masked}");
        }
    }
}
