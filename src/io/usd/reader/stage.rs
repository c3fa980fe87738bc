//! Composed stage of USD layers in memory: the only file that names the package `openusd`.
//!
//! The package composes references, payloads, sublayers, inherits and variants; this file gives its prims and values in types of
//! this crate. UsdLayers come from [`UsdLayers`], never from a file system.

use crate::usd::reader::layers::{UsdLayers, joined};
use openusd::ar::{Asset, ResolvedPath, Resolver};
use openusd::sdf::{Path, Value};
use openusd::usd;
use std::cell::RefCell;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use std::sync::Arc;
use std::time::SystemTime;

/// Fault of a file or of a value, in words.
pub(super) type Fault = String;

/// Composed stage.
pub(super) struct Stage(usd::Stage);

/// Prim of a stage.
#[derive(Clone)]
pub(super) struct Prim(usd::Prim);

/// Value of an attribute or of metadata.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum UsdValue {
    Flag(bool),
    Token(String),
    Tokens(Vec<String>),
    Number(f64),
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    /// Components of a vector, a quaternion (w, x, y, z) or a matrix (its rows, to be multiplied from the left).
    Components(Vec<f64>),
    /// Rows of so many components.
    Rows(usize, Vec<f64>),
    /// Value of a type that no mesh has.
    Other,
}

/// Value of an attribute, and whether it changes over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sampled {
    pub(super) value: UsdValue,
    pub(super) is_animated: bool,
}

/// Runs `read`; returns `None` if the package panics in it: its decoders and its composition index into the data of the file, and
/// what [`crate::usd::reader::binary`] does not foresee must not end the program.
pub(super) fn guarded<T>(read: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(read)).ok()
}

impl Stage {
    /// Composes the stage of the layer `root` of `layers`.
    pub(super) fn open(layers: &Rc<RefCell<UsdLayers>>, root: &str) -> Result<Self, Fault> {
        let resolver = LayerResolver { layers: Rc::clone(layers) };
        usd::Stage::builder().resolver(resolver).open(root).map(Self).map_err(words)
    }

    /// Returns the prim above all others.
    pub(super) fn root(&self) -> Prim {
        Prim(self.0.prim(Path::abs_root()))
    }

    /// Returns metadata of the stage.
    pub(super) fn metadata(&self, name: &str) -> Result<Option<UsdValue>, Fault> {
        self.0.stage_metadata(name).map(|value| value.map(converted)).map_err(words)
    }

    /// Returns what could not be composed, in words, each with the address of the layer that could not be had.
    pub(super) fn composition_faults(&self) -> Vec<(String, Option<String>)> {
        use openusd::pcp::Error;
        let address = |error: &Error| match error {
            Error::UnresolvedLayer { asset_path, .. }
            | Error::MalformedLayer { asset_path, .. }
            | Error::UnresolvedSublayer { asset_path, .. }
            | Error::MalformedSublayer { asset_path, .. } => Some(asset_path.clone()),
            _ => None,
        };
        self.0.composition_errors().iter().map(|error| (error.to_string(), address(error))).collect()
    }
}

impl Prim {
    pub(super) fn path(&self) -> String {
        self.0.path().as_str().to_owned()
    }

    pub(super) fn name(&self) -> String {
        self.0.path().name().unwrap_or_default().to_owned()
    }

    /// Returns the type, as `Mesh`; empty without one.
    pub(super) fn kind(&self) -> Result<String, Fault> {
        let kind = self.0.type_name().map_err(words)?;
        Ok(kind.map(|kind| kind.as_str().to_owned()).unwrap_or_default())
    }

    /// Returns the prims directly below.
    ///
    /// # Errors
    /// A name that is none: the package takes paths apart at their marks, and follows one with a foreign mark without end.
    pub(super) fn children(&self) -> Result<Vec<Prim>, Fault> {
        let children = self.0.children().map_err(words)?;
        for child in &children {
            let path = child.path().as_str();
            let name = path.rsplit('/').next().unwrap_or_default();
            let parent = path.strip_suffix(name).unwrap_or_default().trim_end_matches('/');
            if !Path::is_valid_identifier(name) || parent != self.0.path().as_str().trim_end_matches('/') {
                return Err(format!("{path} is no name of a prim"));
            }
        }
        Ok(children.into_iter().map(Prim).collect())
    }

    /// Returns whether the prim is active, loaded, defined and not abstract, given that the prims above it are.
    pub(super) fn is_shown(&self) -> Result<bool, Fault> {
        let is_there = self.0.is_active().map_err(words)? && self.0.is_defined().map_err(words)?;
        Ok(is_there && !self.0.is_abstract().map_err(words)?)
    }

    pub(super) fn is_instance(&self) -> Result<bool, Fault> {
        self.0.is_instance().map_err(words)
    }

    /// Returns the variant sets of the prim and what is selected of each.
    pub(super) fn variants(&self) -> Result<Vec<(String, String)>, Fault> {
        self.0.variant_sets().get_all_variant_selections().map_err(words)
    }

    /// Returns the names of the attributes and relationships.
    pub(super) fn properties(&self) -> Result<Vec<String>, Fault> {
        let names = self.0.property_names().map_err(words)?;
        let is_sound = |name: &&str| Path::is_valid_namespace_identifier(name);
        Ok(names.iter().map(|name| name.as_str()).filter(is_sound).map(str::to_owned).collect())
    }

    /// Returns an attribute.
    ///
    /// # Errors
    /// A name that is none: see [`Prim::children`].
    fn attribute(&self, name: &str) -> Result<usd::Attribute, Fault> {
        match Path::is_valid_namespace_identifier(name) {
            true => Ok(self.0.attribute(name)),
            false => Err(format!("\"{name}\" is no name of an attribute")),
        }
    }

    /// Returns the value of an attribute outside of time; of one that has none, its earliest sample.
    pub(super) fn value(&self, name: &str) -> Result<Option<Sampled>, Fault> {
        let attribute = self.attribute(name)?;
        let times = attribute.time_sample_times().map_err(words)?;
        let is_animated = times.len() > 1;
        let sampled = |value: Value| Sampled { value: converted(value), is_animated };
        match attribute.get::<Value>().map_err(words)? {
            Some(Value::ValueBlock | Value::None) if times.is_empty() => Ok(None),
            Some(value) if !matches!(value, Value::ValueBlock | Value::None) => Ok(Some(sampled(value))),
            _ if times.is_empty() => Ok(None),
            _ => {
                let first = times.into_iter().fold(f64::INFINITY, f64::min);
                let value = attribute.get_at::<Value>(usd::TimeCode::new(first)).map_err(words)?;
                Ok(value.map(sampled))
            }
        }
    }

    /// Returns the type of an attribute, as `texCoord2f[]`; empty without one.
    pub(super) fn attribute_type(&self, name: &str) -> Result<String, Fault> {
        let kind = self.attribute(name)?.type_name().map_err(words)?;
        Ok(kind.map(|kind| kind.as_str().to_owned()).unwrap_or_default())
    }

    /// Returns metadata of an attribute that is a name.
    pub(super) fn attribute_token(&self, attribute: &str, name: &str) -> Result<Option<String>, Fault> {
        let value = self.attribute(attribute)?.get_metadata::<Value>(name).map_err(words)?;
        Ok(match value.map(converted) {
            Some(UsdValue::Token(token)) => Some(token),
            _ => None,
        })
    }

    /// Returns the paths that a relationship targets.
    pub(super) fn targets(&self, name: &str) -> Result<Vec<String>, Fault> {
        let targets = self.0.relationship(name).targets().map_err(words)?;
        Ok(targets.iter().map(|path| path.as_str().to_owned()).collect())
    }
}

/// Returns an error of the package with its causes.
fn words(error: impl std::fmt::Display) -> Fault {
    format!("{error:#}")
}

fn converted(value: Value) -> UsdValue {
    let rows = |width: usize, all: Vec<f64>| UsdValue::Rows(width, all);
    match value {
        Value::Bool(flag) => UsdValue::Flag(flag),
        Value::Token(token) => UsdValue::Token(token.as_str().to_owned()),
        Value::String(text) => UsdValue::Token(text),
        Value::TokenVec(tokens) => UsdValue::Tokens(tokens.iter().map(|t| t.as_str().to_owned()).collect()),
        Value::StringVec(texts) => UsdValue::Tokens(texts),
        Value::Int(x) => UsdValue::Number(f64::from(x)),
        Value::Half(x) => UsdValue::Number(x.to_f64()),
        Value::Float(x) => UsdValue::Number(f64::from(x)),
        Value::Double(x) => UsdValue::Number(x),
        Value::IntVec(all) => UsdValue::Integers(all.into_iter().map(i64::from).collect()),
        Value::UintVec(all) => UsdValue::Integers(all.into_iter().map(i64::from).collect()),
        Value::Int64Vec(all) => UsdValue::Integers(all),
        Value::HalfVec(all) => UsdValue::Numbers(all.iter().map(|x| x.to_f64()).collect()),
        Value::FloatVec(all) => UsdValue::Numbers(all.into_iter().map(f64::from).collect()),
        Value::DoubleVec(all) => UsdValue::Numbers(all),
        Value::Vec3h(v) => UsdValue::Components(vec![v.x.to_f64(), v.y.to_f64(), v.z.to_f64()]),
        Value::Vec3f(v) => UsdValue::Components([v.x, v.y, v.z].map(f64::from).to_vec()),
        Value::Vec3d(v) => UsdValue::Components(vec![v.x, v.y, v.z]),
        Value::Quath(q) => UsdValue::Components([q.w, q.x, q.y, q.z].map(|x| x.to_f64()).to_vec()),
        Value::Quatf(q) => UsdValue::Components([q.w, q.x, q.y, q.z].map(f64::from).to_vec()),
        Value::Quatd(q) => UsdValue::Components(vec![q.w, q.x, q.y, q.z]),
        Value::Matrix4d(m) => UsdValue::Components(m.0.to_vec()),
        Value::Vec2hVec(all) => rows(2, all.iter().flat_map(|v| [v.x, v.y].map(|x| x.to_f64())).collect()),
        Value::Vec2fVec(all) => rows(2, all.iter().flat_map(|v| [v.x, v.y].map(f64::from)).collect()),
        Value::Vec2dVec(all) => rows(2, all.iter().flat_map(|v| [v.x, v.y]).collect()),
        Value::Vec3hVec(all) => {
            rows(3, all.iter().flat_map(|v| [v.x, v.y, v.z].map(|x| x.to_f64())).collect())
        }
        Value::Vec3fVec(all) => rows(3, all.iter().flat_map(|v| [v.x, v.y, v.z].map(f64::from)).collect()),
        Value::Vec3dVec(all) => rows(3, all.iter().flat_map(|v| [v.x, v.y, v.z]).collect()),
        Value::Vec4fVec(all) => {
            rows(4, all.iter().flat_map(|v| [v.x, v.y, v.z, v.w].map(f64::from)).collect())
        }
        Value::Vec4hVec(all) => {
            rows(4, all.iter().flat_map(|v| [v.x, v.y, v.z, v.w].map(|x| x.to_f64())).collect())
        }
        Value::Vec4dVec(all) => rows(4, all.iter().flat_map(|v| [v.x, v.y, v.z, v.w]).collect()),
        _ => UsdValue::Other,
    }
}

/// Finds layers in memory.
struct LayerResolver {
    layers: Rc<RefCell<UsdLayers>>,
}

impl Resolver for LayerResolver {
    fn create_identifier(&self, asset_path: &str, anchor: Option<&ResolvedPath>) -> String {
        joined(&anchor.map(|anchor| anchor.to_string_lossy().into_owned()).unwrap_or_default(), asset_path)
    }

    fn resolve(&self, asset_path: &str) -> Option<ResolvedPath> {
        self.layers.borrow_mut().find(asset_path).map(ResolvedPath::new)
    }

    fn resolve_for_new_asset(&self, _asset_path: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, resolved_path: &ResolvedPath) -> std::io::Result<Box<dyn Asset>> {
        let content = self.layers.borrow().content(&resolved_path.to_string_lossy());
        let content = content.ok_or(std::io::ErrorKind::NotFound)?;
        Ok(Box::new(LayerBytes(Cursor::new(content))))
    }

    fn get_modification_timestamp(&self, _asset_path: &str, _resolved: &ResolvedPath) -> Option<SystemTime> {
        None
    }
}

/// Content of a layer.
struct LayerBytes(Cursor<Arc<[u8]>>);

impl Read for LayerBytes {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Seek for LayerBytes {
    fn seek(&mut self, position: SeekFrom) -> std::io::Result<u64> {
        self.0.seek(position)
    }
}

impl Asset for LayerBytes {
    fn size(&self) -> std::io::Result<u64> {
        Ok(self.0.get_ref().len() as u64)
    }
}
