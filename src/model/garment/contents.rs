//! Doubts about the content of a file: a body beside the garment, copies or levels of detail in one place, several garments,
//! open seams. Each is told, with the option that chooses or mends.

use crate::error::{Error, Message, Setting};
use crate::garment::open_seams::open_seams;
use crate::garment::shell::Shells;
use crate::garment::tuning::TUNING;
use crate::garment::{Garment, SourceAsset, SourcePiece};
use crease_geometry::math::{Vec3, bounds};
use crease_geometry::mesh::{Groups, PointIndex, Topology, loop_length, triangle};

/// Returns a warning for each thing among the worn pieces of `asset`, from which `garment` was made, that is probably not
/// meant to be simulated with the others, and one for open seams.
pub fn content_warnings(asset: &SourceAsset, garment: &Garment) -> Vec<Message> {
    let things = things(asset, garment);
    let (bodies, cloth) = bodies_and_cloth(&things);
    let mut warnings: Vec<Message> = open_seams(garment).into_iter().collect();
    if let (Some(body), Some(open)) = (bodies.first(), cloth.first()) {
        let (what, help) = body.mistaken_for_cloth(open, &asset.file);
        warnings.push(Message::from(format!("\"{}\" {what}: ", body.name)) + help);
    }
    let mut copied = false;
    for (k, a) in cloth.iter().enumerate() {
        for b in cloth[k + 1..].iter().filter(|b| a.extent.is_in_place_of(&b.extent)) {
            copied = true;
            let what = format!(
                "\"{}\" ({} triangles) and \"{}\" ({}) fill the same place: copies, levels of detail or a lining; all are \
                 simulated, ",
                a.name,
                a.triangles.len(),
                b.name,
                b.triangles.len()
            );
            warnings.push(Message::from(what) + Setting::Garment.to_name(&a.name) + " chooses one");
        }
    }
    let largest = cloth.iter().map(|thing| thing.extent.area).fold(0.0, f64::max);
    let garments: Vec<&&Thing> = cloth
        .iter()
        .filter(|thing| thing.extent.area >= TUNING.min_garment_area_fraction * largest)
        .collect();
    if garments.len() > 1 && !copied {
        let names: Vec<String> = garments
            .iter()
            .take(TUNING.max_listed_things)
            .map(|thing| format!("\"{}\"", thing.name))
            .collect();
        let more = if garments.len() > names.len() { ", ..." } else { "" };
        let what = format!(
            "{} separate pieces of cloth are simulated together: {}{more}; ",
            garments.len(),
            names.join(", ")
        );
        warnings.push(Message::from(what) + Setting::Garment + " NAME chooses one");
    }
    for thickness in Shells::find(garment.into()).doubtful {
        let what = format!(
            "a part without any opening is only {:.1} mm thick, but has no rim between two sides: all of it is simulated. If it is cloth \
             that was exported with its thickness, export one side of it (Blender: switch off Solidify), or keep the rim",
            1e3 * thickness
        );
        warnings.push(what.into());
    }
    warnings
}

/// The error of a body among the worn pieces of `asset` beside open cloth, where there is no doubt: a closed solid that a skin
/// moves. It would be simulated as cloth for a long time.
pub fn mistaken_body(asset: &SourceAsset, garment: &Garment) -> Option<Error> {
    let things = things(asset, garment);
    let (bodies, cloth) = bodies_and_cloth(&things);
    let body = bodies.into_iter().find(|body| body.is_skinned && body.is_closed())?;
    let (what, help) = body.mistaken_for_cloth(cloth.first()?, &asset.file);
    Some(Error::input(&asset.file, format!("\"{}\"", body.name), what, help))
}

/// Things larger than trims: those that look like bodies, and the others.
fn bodies_and_cloth(things: &[Thing]) -> (Vec<&Thing>, Vec<&Thing>) {
    let large = things.iter().filter(|thing| thing.size() > TUNING.max_trim_diagonal);
    large.partition(|thing| thing.is_body())
}

/// Pieces of a file with common points, or one alone.
struct Thing {
    name: String,
    extent: PieceExtent,
    /// Enclosed volume, without sign \[m³\].
    volume: f64,
    triangles: Vec<[PointIndex; 3]>,
    /// Area of its openings, as circles of their length, over that of its triangles \[-\].
    open_fraction: f64,
    is_skinned: bool,
}

impl Thing {
    fn size(&self) -> f64 {
        self.extent.size()
    }

    fn is_closed(&self) -> bool {
        self.open_fraction <= TUNING.max_open_fraction
            && self.volume > TUNING.min_solid_thickness * self.extent.area
    }

    /// Whether its name is that of a body; "body" and "skin" may be panels or materials of a garment that no skin moves.
    fn is_named_body(&self) -> bool {
        let name = self.name.to_lowercase();
        let words: &[&str] =
            if self.is_skinned { &["avatar", "mannequin", "body", "skin"] } else { &["avatar", "mannequin"] };
        name.split(|c: char| !c.is_alphabetic()).any(|part| words.contains(&part))
    }

    fn is_body(&self) -> bool {
        self.size() >= TUNING.min_body_size && (self.is_closed() || self.is_named_body())
    }

    /// Problem and cure where this body is taken for cloth beside the cloth `open`.
    fn mistaken_for_cloth(&self, open: &Self, file: &str) -> (String, Message) {
        let what =
            format!("looks like a body ({:.2} m, {}) and is taken for cloth", self.size(), self.reason());
        let help = Message::from("choose the garment with ")
            + Setting::Garment.to_name(&open.name)
            + "; to dress the body, add "
            + Setting::Body.to(file)
            + " "
            + Setting::BodyNode.to_name(&self.name);
        (what, help)
    }

    fn reason(&self) -> &'static str {
        match (self.is_closed(), self.is_skinned) {
            (true, true) => "closed all around, skinned",
            (true, false) => "closed all around",
            _ => "by its name",
        }
    }
}

/// Place and size of a piece or a thing.
#[derive(Debug, Clone, Copy)]
struct PieceExtent {
    low: Vec3,
    high: Vec3,
    /// Area of its triangles \[m²\].
    area: f64,
    /// Sum of their area vectors \[m²\]: opposite for front and back of a flat garment, small for a closed shape.
    area_vector: Vec3,
}

impl PieceExtent {
    fn of(piece: &SourcePiece) -> Self {
        let at = |v: u32| piece.scene_position(v as usize).unwrap_or_else(Vec3::zeros);
        Self::of_triangles(&piece.triangles.iter().map(|t| t.map(at)).collect::<Vec<_>>())
    }

    fn of_triangles(corners: &[[Vec3; 3]]) -> Self {
        let (low, high) = bounds(corners.as_flattened());
        let vectors = || corners.iter().map(|t| 0.5 * triangle::area_vector(t));
        Self { low, high, area: vectors().map(|v| v.norm()).sum(), area_vector: vectors().sum() }
    }

    fn size(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// Whether both fill the same box and face the same side.
    fn is_in_place_of(&self, other: &Self) -> bool {
        let tolerance = TUNING.same_place_tol * self.size().max(other.size());
        (self.low - other.low).amax() <= tolerance
            && (self.high - other.high).amax() <= tolerance
            && (self.area_vector - other.area_vector).norm()
                <= TUNING.same_side_tol * self.area.max(other.area)
    }
}

fn things(asset: &SourceAsset, garment: &Garment) -> Vec<Thing> {
    let pieces: Vec<&SourcePiece> = asset.worn_pieces().collect();
    let boxes: Vec<PieceExtent> = pieces.iter().map(|piece| PieceExtent::of(piece)).collect();
    let mut groups = Groups::new(pieces.len());
    let mut first: Vec<Option<u32>> = vec![None; garment.points.len()];
    let mut points_of: Vec<&[PointIndex]> = Vec::new();
    let mut rest = &garment.source_point[..];
    for (k, piece) in pieces.iter().enumerate() {
        let Some((own, after)) = rest.split_at_checked(piece.positions.len()) else { return Vec::new() };
        for &v in piece.triangles.iter().flatten() {
            if let Some(slot) = own.get(v as usize).and_then(|p| first.get_mut(p.at())) {
                let other = *slot.get_or_insert(k as u32);
                // Copies and levels of detail meet at their borders.
                if !boxes[k].is_in_place_of(&boxes[other as usize]) {
                    groups.join(other, k as u32);
                }
            }
        }
        points_of.push(own);
        rest = after;
    }
    let (thing_of, count) = groups.numbered();
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    thing_of.iter().enumerate().for_each(|(k, thing)| members[thing.at()].push(k));
    let names: Vec<&str> = members.iter().map(|m| pieces[m[0]].name.as_str()).collect();
    let thing = |own: &Vec<usize>| {
        let name = pieces[own[0]].name.as_str();
        // Primitives of one mesh have one name: their materials tell them apart.
        let name = match (&pieces[own[0]].material, names.iter().filter(|n| **n == name).count()) {
            (Some(material), 2..) => material.as_str(),
            _ => name,
        };
        let corners = own.iter().flat_map(|&k| pieces[k].triangles.iter().map(move |t| (k, t)));
        let triangles = corners.map(|(k, t)| t.map(|v| points_of[k][v as usize]));
        let triangles: Vec<[PointIndex; 3]> =
            triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        measure(name, garment, triangles, own.iter().any(|&k| !pieces[k].joints.is_empty()))
    };
    members.iter().map(thing).collect()
}

fn measure(name: &str, garment: &Garment, triangles: Vec<[PointIndex; 3]>, is_skinned: bool) -> Thing {
    let corners: Vec<[Vec3; 3]> = triangles.iter().map(|t| triangle::corners(&garment.points, t)).collect();
    let extent = PieceExtent::of_triangles(&corners);
    let low = extent.low;
    let borders = Topology::new(garment.points.len(), &triangles).boundary_loops(&triangles);
    let openings = borders
        .iter()
        .map(|border| loop_length(&garment.points, border).powi(2) / (4.0 * std::f64::consts::PI));
    Thing {
        name: name.to_owned(),
        extent,
        volume: corners
            .iter()
            .map(|[a, b, c]| (a - low).dot(&(b - low).cross(&(c - low))) / 6.0)
            .sum::<f64>()
            .abs(),
        open_fraction: openings.sum::<f64>() / extent.area.max(f64::MIN_POSITIVE),
        triangles,
        is_skinned,
    }
}
