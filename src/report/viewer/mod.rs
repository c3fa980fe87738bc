//! The viewer: a self-contained page of worn garments, which needs no network and no other file.
//!
//! The page shows the GLB of each garment itself, with the vertices of its worn surface where it has no map of that, its materials, normal map, skins and clips; blends or wipes between
//! source and worn shape; colours by a quantity; describes the point under the pointer and its hinge with the largest
//! memory; plays clips and the frames of a bake; and shows garments side by side with a common scale and camera. It is drawn
//! by three.js (`three/`, bundled by `three/build.mjs`); `page/` holds the page itself. Numbers are embedded as 32-bit
//! floats in base64, positions of frames as 16-bit fractions of their bounding box.

use crate::report::garment_view::{ColorBy, GarmentView};
use crate::report::html::escaped;
use crate::report::render::{ColourMap, Values, is_viewed_from_above};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{INVALID, PointIndex};
use crease_io::Sidecar;
use crease_model::garment::{SourceAsset, SourcePiece};
use crease_model::remesh::FineVertex;
use serde_json::{Value, json};

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// three.js with its licence in the first line.
const LIBRARY: &str = include_str!("three/three.min.js");
/// Scripts of the page, in the order in which they use each other.
const SCRIPTS: [&str; 3] =
    [include_str!("page/garment.js"), include_str!("page/stage.js"), include_str!("page/page.js")];

/// A garment on the page.
#[derive(Debug, Clone)]
pub struct ViewerItem {
    /// Heading.
    pub name: String,
    /// The garment as GLB file, with its pictures.
    pub glb: Vec<u8>,
    /// Worn pieces of the file, in its order.
    pub pieces: Vec<ViewerPiece>,
    /// Per worn piece: vertices of `glb` that the file does not have, as means of those of all worn pieces of the file.
    pub added: Vec<Vec<FineVertex>>,
    /// Shapes and memory.
    pub view: GarmentView,
    /// Hinges, if there is a sidecar.
    pub hinges: Vec<HingeLabel>,
    /// Positions over time [m]: one list per frame with one entry per point.
    pub frames: Vec<Vec<Vec3>>,
}

/// A worn piece of the file of a garment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewerPiece {
    /// Index of its mesh.
    pub mesh: usize,
    /// Index of its primitive in the mesh.
    pub primitive: usize,
    /// Number of its vertices.
    pub count: usize,
}

impl ViewerPiece {
    /// Returns the worn pieces of `asset`, in the GLB file of [`crease_io::gltf::plain_glb`].
    pub fn of_asset(asset: &SourceAsset) -> Vec<Self> {
        let is_gltf = asset.document.is_some();
        // Pieces of an OBJ become primitives of one mesh, those without triangles are left out.
        let drawn = asset.pieces.iter().filter(|piece| is_gltf || !piece.triangles.is_empty()).enumerate();
        let place = |(k, piece): (usize, &SourcePiece)| match is_gltf {
            true => (piece.mesh, piece.primitive),
            false => (0, k),
        };
        drawn
            .filter(|(_, piece)| piece.worn)
            .map(|(k, piece)| {
                let (mesh, primitive) = place((k, piece));
                Self { mesh, primitive, count: piece.positions.len() }
            })
            .collect()
    }
}

/// Description of one hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeLabel {
    /// End points of its edge.
    pub points: [u32; 2],
    /// Angle in the source shape [degrees].
    pub source_deg: f64,
    /// Rest angle [degrees].
    pub rest_deg: f64,
    /// Stiffness ratio [-].
    pub stiffness: f64,
}

impl HingeLabel {
    /// Returns the labels of all hinges of a sidecar, in its order.
    pub fn from_sidecar(sidecar: &Sidecar) -> Vec<Self> {
        let hinges = &sidecar.hinges;
        let angles = hinges.source_angle_rad.iter().zip(&hinges.rest_angle_rad).zip(&hinges.stiffness_ratio);
        hinges
            .points
            .iter()
            .zip(angles)
            .map(|(points, ((source, rest), stiffness))| Self {
                points: [points[0], points[1]],
                source_deg: source.to_degrees(),
                rest_deg: rest.to_degrees(),
                stiffness: *stiffness,
            })
            .collect()
    }
}

/// Returns the page of `items`. `color_by` is the initial quantity; `frame_names` has one entry per frame.
pub fn viewer_page(items: &[ViewerItem], color_by: ColorBy, frame_names: &[String]) -> String {
    let title = items.iter().map(|item| item.name.as_str()).collect::<Vec<_>>().join(", ");
    let data = json!({
        "garments": items.iter().map(garment).collect::<Vec<_>>(),
        "maps": {"sequential": scale(ColourMap::Sequential), "diverging": scale(ColourMap::Diverging)},
        "show": color_by.name(),
        "frame_names": frame_names,
    });
    // A name must not end the data block.
    let data = data.to_string().replace('<', "\\u003c");
    let parts = [
        ("TITLE", escaped(&title)),
        ("STYLE", STYLE.to_owned()),
        ("DATA", data),
        ("LIBRARY", LIBRARY.to_owned()),
        ("SCRIPT", SCRIPTS.concat()),
    ];
    let (mut page, mut rest) = (String::new(), PAGE);
    for (mark, part) in parts {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        page += before;
        page += &part;
        rest = after;
    }
    page + rest
}

fn is_item_lying(item: &ViewerItem) -> bool {
    let (low, high) = bounds(&item.view.after);
    is_viewed_from_above(&(high - low))
}

fn scale(map: ColourMap) -> Vec<[u8; 3]> {
    (0..=60).map(|k| map.srgb(f64::from(k) / 60.0)).collect()
}

fn garment(item: &ViewerItem) -> Value {
    let view = &item.view;
    let points = view.vertex_points.iter().flat_map(|p| p.0.to_le_bytes());
    let Strongest { per_point, list } = strongest(view.before.len(), &item.hinges);
    let (low, size) = frame_box(&item.frames);
    let added = || item.added.iter().flatten();
    let of = added().flat_map(|vertex| vertex.of).flat_map(u32::to_le_bytes);
    json!({
        "name": item.name,
        "lies": is_item_lying(item),
        "glb": STANDARD.encode(&item.glb),
        "pieces": item.pieces.iter()
            .enumerate()
            .map(|(k, piece)| {
                let added = item.added.get(k).map_or(0, Vec::len);
                json!({"mesh": piece.mesh, "primitive": piece.primitive, "count": piece.count, "added": added})
            })
            .collect::<Vec<_>>(),
        "points": STANDARD.encode(points.collect::<Vec<u8>>()),
        "added_of": STANDARD.encode(of.collect::<Vec<u8>>()),
        "added_weights": floats(added().flat_map(|vertex| vertex.weights)),
        "added_points": STANDARD.encode(added().flat_map(|vertex| vertex.point.to_le_bytes()).collect::<Vec<u8>>()),
        "fields": ColorBy::ALL.iter().filter_map(|color_by| field(view, *color_by)).collect::<Vec<_>>(),
        "hinge": (!item.hinges.is_empty())
            .then(|| STANDARD.encode(per_point.iter().flat_map(|h| h.to_le_bytes()).collect::<Vec<u8>>())),
        "hinges": list,
        "frames": item.frames.iter().map(|frame| quantised(frame, &low, &size)).collect::<Vec<_>>(),
        "frame_low": [low.x, low.y, low.z],
        "frame_size": [size.x, size.y, size.z],
    })
}

fn floats(values: impl Iterator<Item = f64>) -> String {
    STANDARD.encode(values.flat_map(|x| (x as f32).to_le_bytes()).collect::<Vec<u8>>())
}

/// Returns the data of `color_by`; `None` if the garment lacks the quantity.
fn field(view: &GarmentView, color_by: ColorBy) -> Option<Value> {
    let field = view.field_of(color_by)?;
    let values = match &field.values {
        Values::PerPoint(values) => values.clone(),
        Values::PerTriangle(values) => mean_per_point(view.before.len(), &view.triangles, values),
    };
    Some(json!({
        "name": color_by.name(),
        "title": field.title,
        "unit": field.unit,
        "map": match field.map { ColourMap::Sequential => "sequential", ColourMap::Diverging => "diverging" },
        "limits": field.limits(),
        "values": floats(values.into_iter()),
    }))
}

/// Returns per point the mean of the values of its triangles; not a number where it has none.
fn mean_per_point(point_count: usize, triangles: &[[PointIndex; 3]], values: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0u32); point_count];
    for (t, value) in triangles.iter().zip(values) {
        for p in t {
            if let Some((sum, count)) = sums.get_mut(p.at()) {
                *sum += value;
                *count += 1;
            }
        }
    }
    sums.into_iter().map(|(sum, count)| sum / f64::from(count)).collect()
}

/// Hinges with the largest memory.
struct Strongest {
    /// Per point: index in `list` of its hinge with the largest change of rest angle, or [`INVALID`].
    per_point: Vec<u32>,
    /// Per hinge: number, end points, source angle and rest angle [degrees], stiffness ratio.
    list: Vec<Value>,
}

/// Returns the hinge with the largest change of rest angle of every point.
fn strongest(point_count: usize, hinges: &[HingeLabel]) -> Strongest {
    let mut best: Vec<Option<usize>> = vec![None; point_count];
    let change = |h: usize| hinges.get(h).map_or(0.0, |h| (h.rest_deg - h.source_deg).abs());
    for (h, hinge) in hinges.iter().enumerate() {
        for p in hinge.points {
            if let Some(slot) = best.get_mut(p as usize)
                && slot.is_none_or(|old| change(h) > change(old))
            {
                *slot = Some(h);
            }
        }
    }
    let mut named: Vec<usize> = best.iter().flatten().copied().collect();
    named.sort_unstable();
    named.dedup();
    let index = |h: usize| named.binary_search(&h).map_or(INVALID, |k| k as u32);
    let per_point = best.iter().map(|h| h.map_or(INVALID, index)).collect();
    let rounded = |x: f64| (x * 1e4).round() / 1e4;
    let list = named
        .iter()
        .filter_map(|&h| hinges.get(h).map(|hinge| (h, hinge)))
        .map(|(h, hinge)| {
            let [a, b] = hinge.points;
            json!([h, a, b, rounded(hinge.source_deg), rounded(hinge.rest_deg), rounded(hinge.stiffness)])
        })
        .collect();
    Strongest { per_point, list }
}

/// Returns the lower corner and the size of the bounding box of all frames [m].
fn frame_box(frames: &[Vec<Vec3>]) -> (Vec3, Vec3) {
    let all: Vec<Vec3> =
        frames.iter().flatten().filter(|p| p.iter().all(|c| c.is_finite())).copied().collect();
    if all.is_empty() {
        return (Vec3::zeros(), Vec3::zeros());
    }
    let (low, high) = bounds(&all);
    (low, high - low)
}

/// Quantises a frame to 16 bits per coordinate: 1/65535 of the box, less than 0.01 mm for a garment.
fn quantised(frame: &[Vec3], low: &Vec3, size: &Vec3) -> String {
    let coordinate = |p: &Vec3, k: usize| {
        let fraction = (p[k] - low[k]) / size[k].max(f64::MIN_POSITIVE);
        // NaN becomes 0.
        ((65535.0 * fraction).round() as u16).to_le_bytes()
    };
    STANDARD
        .encode(frame.iter().flat_map(|p| [0, 1, 2].map(|k| coordinate(p, k))).flatten().collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::render::test_shapes::sphere;

    fn item(name: &str) -> ViewerItem {
        let (before, triangles) = sphere(0.3, 6);
        let after = before.iter().map(|p| p * 1.1).collect();
        let view = GarmentView::of_shapes(name, [before, after], triangles);
        let hinges = vec![
            HingeLabel { points: [0, 1], source_deg: 1.0, rest_deg: 3.0, stiffness: 1.5 },
            HingeLabel { points: [1, 2], source_deg: 0.0, rest_deg: -40.0, stiffness: 2.0 },
        ];
        let pieces = vec![ViewerPiece { mesh: 0, primitive: 0, count: view.before.len() }];
        let (name, glb, frames, added) = (name.to_owned(), Vec::new(), Vec::new(), Vec::new());
        ViewerItem { name, glb, pieces, added, view, hinges, frames }
    }

    #[test]
    fn the_page_is_self_contained_and_escapes_names() {
        let page = viewer_page(&[item("a</script><b>\"&"), item("TITLE DATA")], ColorBy::Curvature, &[]);
        for external in ["src=\"http", "href=\"http", "<link"] {
            let own = page.replace(LIBRARY, "");
            assert!(!own.contains(external), "{external}");
        }
        assert_eq!(page.matches("three.js authors, MIT licence").count(), 1, "the library and its licence");
        assert!(page.contains("default-src 'none'"), "the browser refuses requests");
        assert_eq!(page.matches("</script>").count(), 3);
        assert!(page.contains("<title>crease: a&lt;/script&gt;&lt;b&gt;&quot;&amp;, TITLE DATA</title>"));
        let (_, data) = page.split_once("id=\"data\">").expect("a data block");
        let (data, _) = data.split_once("</script>").expect("its end");
        let data: Value = serde_json::from_str(data).expect("is JSON");
        assert_eq!(data["garments"][0]["name"], "a</script><b>\"&");
        assert_eq!(data["garments"].as_array().map(Vec::len), Some(2));
        assert_eq!(data["show"], "curvature");
    }

    #[test]
    fn values_of_triangles_are_averaged_at_points() {
        let t = |corners: [u32; 3]| corners.map(PointIndex);
        let mean = mean_per_point(5, &[t([0, 1, 2]), t([1, 3, 2])], &[1.0, 4.0]);
        assert_eq!(mean[..4], [1.0, 2.5, 2.5, 4.0]);
        assert!(mean[4].is_nan());
    }

    #[test]
    fn every_point_has_the_hinge_with_the_largest_change() {
        let Strongest { per_point, list } = strongest(4, &item("a").hinges);
        assert_eq!(per_point, [0, 1, 1, INVALID]);
        assert_eq!(list[1], json!([1, 1, 2, 0.0, -40.0, 2.0]));
    }

    #[test]
    fn frames_are_exact_to_a_hundredth_of_a_millimetre() {
        let frame =
            vec![Vec3::new(-0.35, 0.0, 0.1), Vec3::new(0.4, 0.5, 0.1), Vec3::new(0.123_456, 0.2, 0.1)];
        let (low, size) = frame_box(std::slice::from_ref(&frame));
        let bytes = STANDARD.decode(quantised(&frame, &low, &size)).expect("is base64");
        let fraction = |k: usize| f64::from(u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]])) / 65535.0;
        for (k, p) in frame.iter().enumerate() {
            for axis in 0..3 {
                assert!((low[axis] + size[axis] * fraction(3 * k + axis) - p[axis]).abs() < 1e-5);
            }
        }
    }
}
