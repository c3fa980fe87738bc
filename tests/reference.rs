//! Numbers of others, which are not part of the repository: intersections of folded garments, ranges of fabrics.

#[path = "reference/external.rs"]
mod external;

use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::fabric::Fabric;
use external::external;
use test_attributes::needs_data;

/// The points and triangles of a plain OBJ file (all of these are triangles, welded).
fn read(text: &str) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.filter_map(|w| w.parse().ok()).collect();
                points.push(Vec3::new(x[0], x[1], x[2]));
            }
            Some("f") => {
                let c: Vec<u32> =
                    words.filter_map(|w| w.split('/').next()?.parse::<u32>().ok()).map(|i| i - 1).collect();
                triangles.push([c[0], c[1], c[2]].map(PointIndex));
            }
            _ => {}
        }
    }
    (points, triangles)
}

/// T-shirts folded by another simulator; an independent program in another language counts the same.
#[needs_data("garments/diffcloth-tshirt-folds")]
#[test]
fn counts_of_folded_shirts_made_by_others() {
    for (name, count) in [
        ("tshirt1900.obj", 0),
        ("tshirt1900-flattened.obj", 0),
        ("tshirt1900-folding-biFolded.obj", 48),
        ("tshirt1900-folding-triFolded.obj", 108),
    ] {
        let file = external("garments/diffcloth-tshirt-folds").join(name);
        let (points, triangles) = read(&std::fs::read_to_string(file).expect(name));
        assert_eq!(triangles.len(), 3726);
        assert_eq!(self_intersections(&points, &triangles).len(), count, "{name}");
    }
}

#[needs_data("reference/fabrics_kes.csv")]
#[test]
fn presets_are_the_middle_of_the_reference_ranges() {
    let text = std::fs::read_to_string(external("reference/fabrics_kes.csv")).expect("reads");
    let presets: Vec<Fabric> =
        Fabric::preset_names().into_iter().map(|name| Fabric::preset(name).expect(name)).collect();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap_or("").split(',').collect();
    let mut checked = 0;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| -> f64 {
            let column = header.iter().position(|h| *h == name).expect(name);
            cells[column].parse().expect(name)
        };
        let middle = |name: &str| (number(&format!("{name}_lo")) * number(&format!("{name}_hi"))).sqrt();
        let fabric = presets.iter().find(|f| f.description == cells[0]).expect(cells[0]);
        let pairs = [
            (fabric.area_density_g_m2, middle("W")),
            (fabric.thickness_mm, middle("T")),
            (fabric.bend_mean(), middle("B") * 98.07e-6),
            (fabric.shear(), middle("G") * 56.19),
            (fabric.stretch_warp(), 490.0 / (middle("EMT") * 0.01)),
        ];
        for (ours, theirs) in pairs {
            assert!((ours / theirs - 1.0).abs() < 0.01, "{}: {ours} is not {theirs}", fabric.name);
        }
        checked += 1;
    }
    assert_eq!(checked, 13);
}
