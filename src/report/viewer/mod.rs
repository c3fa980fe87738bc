//! The viewer: worn garments as one page that works from the disk, with no network and no other file.
//!
//! Turn a garment, let the wear in and out with a slider, switch colourings, hover for a point and its strongest
//! hinge, run through the frames of a bake, compare garments beside each other in one scale and one view. Drawn by
//! plotly.js, which the plotly crate carries; the page's own script (`page.js`) only feeds it. Numbers are embedded as
//! 32-bit floats in base64, frames as 16-bit shares of their box.
//!
//! Does not do: files (the tool writes the page), textures and materials of the glTF (any glTF viewer shows those).

use crate::garment::{Footprint, is_lying};
use crate::io::Sidecar;
use crate::math::{Vec3, bounds};
use crate::report::escaped;
use crate::report::garment_view::{ColorBy, GarmentView};
use crate::report::render::{ColourMap, Values};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");

/// No hinge at a point.
const NO_HINGE: u32 = u32::MAX;
/// A garment lower than this share of its length and width lies, and is looked at from above.
const LYING_SHARE: f64 = 0.35;

/// A garment to be put on the page.
#[derive(Debug, Clone)]
pub struct ViewerItem {
    /// Heading over it.
    pub name: String,
    /// Its shapes and memory.
    pub view: GarmentView,
    /// Its hinges, where there is a sidecar.
    pub hinges: Vec<HingeLabel>,
    /// Positions over time [m], one list per frame, one entry per point.
    pub frames: Vec<Vec<Vec3>>,
}

/// What the page says of one hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeLabel {
    /// Ends of its edge.
    pub points: [u32; 2],
    /// Angle of the garment as it came [degrees].
    pub source_deg: f64,
    /// Rest angle [degrees].
    pub rest_deg: f64,
    /// Stiffness ratio [-].
    pub stiffness: f64,
}

impl HingeLabel {
    /// Of every hinge of a sidecar, in its order.
    pub fn all_of(sidecar: &Sidecar) -> Vec<Self> {
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

/// The page. `show` is what it opens with; `frame_names` say what each frame is.
pub fn viewer_page(items: &[ViewerItem], show: ColorBy, frame_names: &[String]) -> String {
    let title = items.iter().map(|item| item.name.as_str()).collect::<Vec<_>>().join(", ");
    let data = json!({
        "garments": items.iter().map(garment).collect::<Vec<_>>(),
        "maps": {"sequential": scale(ColourMap::Sequential), "diverging": scale(ColourMap::Diverging)},
        "show": show.name(),
        "lies": items.iter().all(lies),
        "frame_names": frame_names,
    });
    // A name that ends the block early must not end it.
    let data = data.to_string().replace('<', "\\u003c");
    let (before, rest) = PAGE.split_once("TITLE").unwrap_or((PAGE, ""));
    let (head, rest) = rest.split_once("DATA").unwrap_or((rest, ""));
    let (middle, rest) = rest.split_once("LIBRARY").unwrap_or((rest, ""));
    let (last, end) = rest.split_once("SCRIPT").unwrap_or((rest, ""));
    let title = escaped(&title);
    [before, &title, head, &data, middle, &library(), last, SCRIPT, end].concat()
}

/// plotly.js in its script element, without the typesetting library that comes after it.
fn library() -> String {
    let mut sources = plotly::Plot::offline_js_sources();
    if let Some(end) = sources.rfind("<script").filter(|at| *at > 0) {
        sources.truncate(end);
    }
    sources
}

fn lies(item: &ViewerItem) -> bool {
    let (low, high) = bounds(&item.view.after);
    let size = high - low;
    is_lying(&size, Footprint::Shorter, LYING_SHARE)
}

fn scale(map: ColourMap) -> Vec<Value> {
    (0..=20)
        .map(|k| {
            let share = f64::from(k) / 20.0;
            let [r, g, b] = map.srgb(share);
            json!([share, format!("rgb({r},{g},{b})")])
        })
        .collect()
}

fn garment(item: &ViewerItem) -> Value {
    let view = &item.view;
    let triangles = view.triangles.iter().flat_map(|t| t.map(|p| p.0.to_le_bytes())).flatten();
    let (hinge, hinges) = strongest(view.before.len(), &item.hinges);
    let (low, size) = frame_box(&item.frames);
    json!({
        "name": item.name,
        "before": positions(&view.before),
        "after": positions(&view.after),
        "triangles": STANDARD.encode(triangles.collect::<Vec<u8>>()),
        "fields": ColorBy::ALL.iter().filter_map(|show| field(view, *show)).collect::<Vec<_>>(),
        "hinge": (!item.hinges.is_empty())
            .then(|| STANDARD.encode(hinge.iter().flat_map(|h| h.to_le_bytes()).collect::<Vec<u8>>())),
        "hinges": hinges,
        "frames": item.frames.iter().map(|frame| shares(frame, &low, &size)).collect::<Vec<_>>(),
        "frame_low": [low.x, low.y, low.z],
        "frame_size": [size.x, size.y, size.z],
    })
}

fn floats(values: impl Iterator<Item = f64>) -> String {
    STANDARD.encode(values.flat_map(|x| (x as f32).to_le_bytes()).collect::<Vec<u8>>())
}

fn positions(x: &[Vec3]) -> String {
    floats(x.iter().flat_map(|p| [p.x, p.y, p.z]))
}

/// A colouring that this garment has.
fn field(view: &GarmentView, show: ColorBy) -> Option<Value> {
    let field = view.field_of(show)?;
    let (Values::PerPoint(values) | Values::PerTriangle(values)) = &field.values;
    Some(json!({
        "name": show.name(),
        "title": field.title,
        "unit": field.unit,
        "map": match field.map { ColourMap::Sequential => "sequential", ColourMap::Diverging => "diverging" },
        "limits": field.limits(),
        "values": floats(values.iter().copied()),
    }))
}

/// Per point the hinge that remembers most, as a place in the list that is returned as well.
fn strongest(point_count: usize, hinges: &[HingeLabel]) -> (Vec<u32>, Vec<Value>) {
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
    let place = |h: usize| named.binary_search(&h).map_or(NO_HINGE, |k| k as u32);
    let per_point = best.iter().map(|h| h.map_or(NO_HINGE, place)).collect();
    let rounded = |x: f64| (x * 1e4).round() / 1e4;
    let list = named
        .iter()
        .filter_map(|&h| hinges.get(h).map(|hinge| (h, hinge)))
        .map(|(h, hinge)| {
            let [a, b] = hinge.points;
            json!([h, a, b, rounded(hinge.source_deg), rounded(hinge.rest_deg), rounded(hinge.stiffness)])
        })
        .collect();
    (per_point, list)
}

fn frame_box(frames: &[Vec<Vec3>]) -> (Vec3, Vec3) {
    let all: Vec<Vec3> =
        frames.iter().flatten().filter(|p| p.iter().all(|c| c.is_finite())).copied().collect();
    if all.is_empty() {
        return (Vec3::zeros(), Vec3::zeros());
    }
    let (low, high) = bounds(&all);
    (low, high - low)
}

/// A frame in 16 bits: 1/65535 of the box, less than a hundredth of a millimetre for a garment.
fn shares(frame: &[Vec3], low: &Vec3, size: &Vec3) -> String {
    let share = |p: &Vec3, k: usize| {
        let share = (p[k] - low[k]) / size[k].max(f64::MIN_POSITIVE);
        // Not a number becomes 0.
        ((65535.0 * share).round() as u16).to_le_bytes()
    };
    STANDARD.encode(frame.iter().flat_map(|p| [0, 1, 2].map(|k| share(p, k))).flatten().collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::super::render::tests::sphere;
    use super::*;

    fn item(name: &str) -> ViewerItem {
        let (before, triangles) = sphere(0.3, 6);
        let after = before.iter().map(|p| p * 1.1).collect();
        let (file, memory) = (name.to_owned(), None);
        let view = GarmentView { file, before, after, triangles, memory, confidence: None };
        let hinges = vec![
            HingeLabel { points: [0, 1], source_deg: 1.0, rest_deg: 3.0, stiffness: 1.5 },
            HingeLabel { points: [1, 2], source_deg: 0.0, rest_deg: -40.0, stiffness: 2.0 },
        ];
        ViewerItem { name: name.to_owned(), view, hinges, frames: Vec::new() }
    }

    #[test]
    fn the_page_needs_nothing_else_and_survives_odd_names() {
        let page = viewer_page(&[item("a</script><b>\"&"), item("TITLE DATA")], ColorBy::Curvature, &[]);
        for far in ["src=\"http", "href=\"http", "<link"] {
            let outside = page.replace(&library(), "");
            assert!(!outside.contains(far), "{far}");
        }
        assert!(
            page.contains("plotly.js v") && !page.contains("MathJax-script"),
            "the library is in it, once"
        );
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
    fn every_point_names_the_hinge_that_remembers_most() {
        let (per_point, list) = strongest(4, &item("a").hinges);
        assert_eq!(per_point, [0, 1, 1, NO_HINGE]);
        assert_eq!(list[1], json!([1, 1, 2, 0.0, -40.0, 2.0]));
    }

    #[test]
    fn frames_are_kept_to_a_hundredth_of_a_millimetre() {
        let frame =
            vec![Vec3::new(-0.35, 0.0, 0.1), Vec3::new(0.4, 0.5, 0.1), Vec3::new(0.123_456, 0.2, 0.1)];
        let (low, size) = frame_box(std::slice::from_ref(&frame));
        let bytes = STANDARD.decode(shares(&frame, &low, &size)).expect("is base64");
        let share = |k: usize| f64::from(u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]])) / 65535.0;
        for (k, p) in frame.iter().enumerate() {
            for axis in 0..3 {
                assert!((low[axis] + size[axis] * share(3 * k + axis) - p[axis]).abs() < 1e-5);
            }
        }
    }
}
