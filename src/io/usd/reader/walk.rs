//! Walk over the prims of a stage: which meshes are read, where they stand, and what is said of the others.

use crate::pieces::{DamagedPiece, NamedPiece};
use crate::polygon::Triangulator;
use crate::tuning::TUNING;
use crate::usd::reader::binary::MAX_DEPTH;
use crate::usd::reader::mesh::{MaskName, MeshFault, read_mesh};
use crate::usd::reader::notes::Notes;
use crate::usd::reader::pieces::{PlacedMesh, bound_material};
use crate::usd::reader::primvar::NAMESPACE;
use crate::usd::reader::stage::{Fault, Prim, Stage, UsdValue};
use crate::usd::reader::transform::prim_transform;
use crease_geometry::math::Mat4;
use crease_model::error::Diagnostic;
use crease_model::garment::Severity;
use std::rc::Rc;

/// Prims that a stage of any size may have; a larger file may have one for every so many bytes. References to one prim can make any
/// number of others, each of which takes memory.
const MIN_PRIM_BUDGET: usize = 4096;
/// Least bytes of a file for each prim beyond that.
const BYTES_OF_PRIM: usize = 8;
/// Most prims of any stage.
const MAX_PRIMS: usize = 200_000;
/// Geometry that is no mesh.
const OTHER_GEOMETRY: [&str; 15] = [
    "BasisCurves",
    "Capsule",
    "Capsule_1",
    "Cone",
    "Cube",
    "Cylinder",
    "Cylinder_1",
    "HermiteCurves",
    "NurbsCurves",
    "NurbsPatch",
    "Plane",
    "Points",
    "Sphere",
    "TetMesh",
    "Volume",
];

/// Result of the walk.
#[derive(Default)]
pub(super) struct Found {
    pub(super) pieces: Vec<NamedPiece>,
    pub(super) damaged: Vec<DamagedPiece>,
    pub(super) notes: Notes,
    /// Names of the primvars of meshes, for messages.
    pub(super) primvars: Vec<String>,
}

/// What a prim has from those above it.
#[derive(Clone)]
struct Inherited {
    /// Transform to the scene, or why there is none.
    to_scene: Result<Mat4, Fault>,
    is_visible: bool,
    /// `default`, `render`, `proxy` or `guide`.
    purpose: Rc<str>,
    material: Option<String>,
    has_skeleton: bool,
    names: Rc<[String]>,
    depth: usize,
}

/// Walk over the prims of a stage.
pub(super) struct Walk<'a> {
    pub(super) file: &'a str,
    /// Transform from the stage to the scene.
    pub(super) to_scene: Mat4,
    pub(super) masks: [Option<MaskName>; 2],
    /// Points and corners that may still come.
    pub(super) element_budget: usize,
    pub(super) triangulator: Triangulator,
    pub(super) found: Found,
    mesh_count: usize,
    position_count: u32,
}

impl<'a> Walk<'a> {
    pub(super) fn new(
        file: &'a str,
        to_scene: Mat4,
        masks: [Option<MaskName>; 2],
        byte_count: usize,
    ) -> Self {
        Self {
            file,
            to_scene,
            masks,
            // Integers of USDC files are compressed.
            element_budget: TUNING.min_element_budget.max(byte_count.saturating_mul(4)),
            triangulator: Triangulator::new(),
            found: Found::default(),
            mesh_count: 0,
            position_count: 0,
        }
    }

    /// Reads all meshes of `stage`, in the order of the file.
    ///
    /// # Errors
    /// What makes the stage unreadable as a whole.
    pub(super) fn run(mut self, stage: &Stage) -> Result<Found, Fault> {
        let above = Inherited {
            to_scene: Ok(self.to_scene),
            is_visible: true,
            purpose: "default".into(),
            material: None,
            has_skeleton: false,
            names: Rc::new([]),
            depth: 0,
        };
        let mut pending: Vec<(Prim, Inherited)> = Vec::new();
        let roots = stage.root().children()?;
        pending.extend(roots.into_iter().rev().map(|prim| (prim, above.clone())));
        while let Some((prim, above)) = pending.pop() {
            check_depth(above.depth, &prim)?;
            let children = self.visit(&prim, above)?;
            pending.extend(children.into_iter().rev());
        }
        if self.triangulator.fan_count > 0 {
            let message = format!(
                "{} faces intersect themselves or have no area: cut as fans",
                self.triangulator.fan_count
            );
            self.found.notes.add(Severity::Note, "", message);
        }
        Ok(self.found)
    }

    /// Reads a prim and returns those below it that are to be visited.
    fn visit(&mut self, prim: &Prim, above: Inherited) -> Result<Vec<(Prim, Inherited)>, Fault> {
        let (path, kind) = (prim.path(), prim.kind()?);
        if !prim.is_shown()? {
            let message = "prims that are inactive, abstract or undefined are skipped, with all below them";
            self.found.notes.count(Severity::Note, &path, message);
            return Ok(Vec::new());
        }
        match kind.as_str() {
            "Material" | "Shader" | "NodeGraph" | "GeomSubset" | "BlendShape" => return Ok(Vec::new()),
            "PointInstancer" => {
                let message = "point instancers are skipped: make their copies meshes to take them";
                self.found.notes.count(Severity::Warning, &path, message);
                return Ok(Vec::new());
            }
            other if OTHER_GEOMETRY.contains(&other) => {
                let message =
                    format!("prims of the type {other} are skipped: convert them to meshes to take them");
                self.found.notes.count(Severity::Note, &path, message);
            }
            _ => {}
        }
        self.note_composition(prim, &path)?;
        let below = self.inherit(prim, &path, above);
        let children = prim.children()?;
        if kind == "Mesh" {
            self.visit_mesh(prim, &path, &children, &below)?;
        }
        Ok(children.into_iter().map(|child| (child, below.clone())).collect())
    }

    fn note_composition(&mut self, prim: &Prim, path: &str) -> Result<(), Fault> {
        for (set, selected) in prim.variants()? {
            let message = format!("the variant \"{selected}\" of \"{set}\" is read, the others are not");
            self.found.notes.add(Severity::Note, path, message);
        }
        if prim.is_instance()? {
            self.found.notes.count(Severity::Note, path, "instances are read as meshes of their own");
        }
        Ok(())
    }

    /// Returns what `prim` and those above it give to those below.
    fn inherit(&mut self, prim: &Prim, path: &str, above: Inherited) -> Inherited {
        let mut below = Inherited { depth: above.depth + 1, ..above };
        match prim_transform(prim) {
            Ok(transform) => {
                let base = if transform.is_reset { Ok(self.to_scene) } else { below.to_scene };
                below.to_scene = base.map(|base| base * transform.matrix);
                if transform.is_animated {
                    let message = "prims move over time: they are read where they are by default, or at the earliest time";
                    self.found.notes.count(Severity::Warning, path, message);
                }
            }
            Err(fault) => below.to_scene = Err(format!("{path}: {fault}")),
        }
        let visibility = self.token(prim, path, "visibility");
        below.is_visible &= visibility.is_none_or(|visibility| visibility != "invisible");
        if let Some(purpose) = self.token(prim, path, "purpose") {
            below.purpose = purpose.into();
        }
        if let Some(material) = self.readable(path, "material:binding", bound_material(prim)).flatten() {
            below.material = Some(material);
        }
        let skeletons = self.readable(path, "skel:skeleton", prim.targets("skel:skeleton"));
        below.has_skeleton |= skeletons.is_some_and(|skeletons| !skeletons.is_empty());
        let mut names = vec![prim.name()];
        names.extend(below.names.iter().cloned());
        below.names = names.into();
        below
    }

    /// Returns what was read of `attribute`; a warning and `None` if it cannot be read.
    fn readable<T>(&mut self, path: &str, attribute: &str, read: Result<T, Fault>) -> Option<T> {
        read.map_err(|fault| {
            let message = format!("{attribute} cannot be read and is left out: {fault}");
            self.found.notes.add(Severity::Warning, path, message);
        })
        .ok()
    }

    /// Returns the token that an attribute holds.
    fn token(&mut self, prim: &Prim, path: &str, attribute: &str) -> Option<String> {
        match self.readable(path, attribute, prim.value(attribute))??.value {
            UsdValue::Token(token) => Some(token),
            _ => None,
        }
    }

    fn visit_mesh(
        &mut self,
        prim: &Prim,
        path: &str,
        children: &[Prim],
        own: &Inherited,
    ) -> Result<(), Fault> {
        if !own.is_visible {
            let message = "meshes are invisible and skipped: make them visible to take them";
            self.found.notes.count(Severity::Note, path, message);
            return Ok(());
        }
        if own.purpose.as_ref() != "default" && own.purpose.as_ref() != "render" {
            let message = format!("meshes have the purpose \"{}\" and are skipped", own.purpose);
            self.found.notes.count(Severity::Note, path, message);
            return Ok(());
        }
        let properties = prim.properties()?;
        for name in properties.iter().filter_map(|name| name.strip_prefix(NAMESPACE)) {
            let is_known = self.found.primvars.iter().any(|known| known == name);
            if !is_known && !name.contains(':') && self.found.primvars.len() < TUNING.max_listed_names {
                self.found.primvars.push(name.to_owned());
            }
        }
        let mut names: Vec<String> = own.names.to_vec();
        names.push(path.to_owned());
        let placed = own.to_scene.clone().map_err(|fault| MeshFault {
            attribute: "xformOpOrder".to_owned(),
            message: format!("its place is not known: {fault}"),
            help: "correct the transform, or apply it to the mesh",
        });
        let read = placed.and_then(|to_scene| Ok((to_scene, read_mesh(prim, &properties, &self.masks)?)));
        let (to_scene, mut data) = match read {
            Ok(read) => read,
            Err(fault) => {
                let location = format!("{path}.{}", fault.attribute);
                let errors = vec![Diagnostic::new(self.file, location, fault.message, fault.help)];
                self.found.damaged.push(DamagedPiece { names, errors });
                return Ok(());
            }
        };
        for (severity, message) in std::mem::take(&mut data.notes) {
            self.found.notes.count(severity, path, message);
        }
        if data.faces.iter().flatten().next().is_none() {
            self.found.notes.count(Severity::Note, path, "meshes without faces are skipped");
            return Ok(());
        }
        self.note_schemas(prim, path, &properties, own.has_skeleton, data.is_animated);
        let elements = data.positions.len() + data.corners.len();
        self.element_budget = self.element_budget.checked_sub(elements).ok_or_else(|| {
            format!("{path}: the meshes have more points than a file of this size can: prims refer to one mesh many times")
        })?;
        let first_position = self.position_count;
        let count =
            u32::try_from(data.positions.len()).ok().and_then(|count| first_position.checked_add(count));
        self.position_count = count.ok_or("the meshes have more than 2^32 points")?;
        let mesh = PlacedMesh {
            prim,
            children,
            data,
            to_scene,
            material: own.material.clone(),
            names,
            number: self.mesh_count,
            first_position,
        };
        self.mesh_count += 1;
        let pieces =
            mesh.into_pieces(self.found.pieces.len(), &mut self.triangulator, &mut self.found.notes)?;
        self.found.pieces.extend(pieces);
        Ok(())
    }

    /// Notes what of a mesh is not carried.
    fn note_schemas(
        &mut self,
        prim: &Prim,
        path: &str,
        properties: &[String],
        has_skeleton: bool,
        is_animated: bool,
    ) {
        let has = |name: &str| properties.iter().any(|own| own == name);
        let notes = &mut self.found.notes;
        if is_animated {
            let message = "meshes change over time: the shape that they have by default, or at the earliest time, is read";
            notes.count(Severity::Warning, path, message);
        }
        if has("primvars:skel:jointIndices") || (has_skeleton && has("primvars:skel:jointWeights")) {
            let message = "meshes have a skeleton, which is not read: they are taken as their points are; a .glb keeps it";
            notes.count(Severity::Warning, path, message);
        }
        if has("skel:blendShapes") {
            let message = "meshes have blend shapes, which are not read: they are taken as their points are";
            notes.count(Severity::Warning, path, message);
        }
        let scheme = self.token(prim, path, "subdivisionScheme");
        let scheme = scheme.unwrap_or_else(|| "catmullClark".to_owned());
        if scheme != "none" {
            let message =
                format!("meshes are to be subdivided ({scheme}): they are read as they are, without that");
            self.found.notes.count(Severity::Note, path, message);
        }
    }
}

/// Visits all prims of `stage`, so that the layers they refer to are asked for. `byte_count` is that of the layers so far.
///
/// # Errors
/// A stage that is too large or too deep.
pub(super) fn survey(stage: &Stage, byte_count: usize) -> Result<(), Fault> {
    let budget = (MIN_PRIM_BUDGET + byte_count / BYTES_OF_PRIM).min(MAX_PRIMS);
    let mut pending: Vec<(Prim, usize)> =
        stage.root().children()?.into_iter().map(|prim| (prim, 0)).collect();
    let mut prim_count = pending.len();
    while let Some((prim, depth)) = pending.pop() {
        check_depth(depth, &prim)?;
        let children = prim.children()?;
        prim_count += children.len();
        if prim_count > budget {
            return Err(format!(
                "{}: there are more than {budget} prims, too many for a file of this size or for any",
                prim.path()
            ));
        }
        pending.extend(children.into_iter().map(|child| (child, depth + 1)));
    }
    Ok(())
}

/// Refuses prims that are nested too deep.
fn check_depth(depth: usize, prim: &Prim) -> Result<(), Fault> {
    if depth > MAX_DEPTH {
        return Err(format!("{}: prims are nested more than {MAX_DEPTH} deep", prim.path()));
    }
    Ok(())
}
