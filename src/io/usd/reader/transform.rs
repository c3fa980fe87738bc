//! Transform of a prim from its `xformOpOrder` (`UsdGeomXformable`).
//!
//! The last operation of the order acts on the points first. Angles are in degrees. A matrix of USD multiplies rows from the right,
//! so it is the transpose of ours.

use crate::usd::reader::stage::{Fault, Prim, UsdValue};
use crease_geometry::math::{Mat4, Vec3};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion};

/// Mark of an operation that is inverted.
const INVERTED: &str = "!invert!";
/// First entry of an order that does not start from the transform of the parent.
const RESET: &str = "!resetXformStack!";
/// Namespace of the operations.
const NAMESPACE: &str = "xformOp:";

/// Transform of a prim.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PrimTransform {
    /// Transform to the parent, or to the stage.
    pub(super) matrix: Mat4,
    /// Whether the transforms of the prims above do not count.
    pub(super) is_reset: bool,
    /// Whether it changes over time: it is that of the default or of the earliest time.
    pub(super) is_animated: bool,
}

/// Reads the transform of `prim`.
///
/// # Errors
/// An operation that is not known, has no number, or cannot be inverted.
pub(super) fn prim_transform(prim: &Prim) -> Result<PrimTransform, Fault> {
    let mut transform = PrimTransform { matrix: Mat4::identity(), is_reset: false, is_animated: false };
    let order = match prim.value("xformOpOrder")? {
        Some(sampled) => match sampled.value {
            UsdValue::Tokens(order) => order,
            _ => return Err("xformOpOrder: is no list of names".to_owned()),
        },
        None => return Ok(transform),
    };
    for operation in &order {
        if operation == RESET {
            // What stands before does not count either.
            (transform.matrix, transform.is_reset) = (Mat4::identity(), true);
            continue;
        }
        let name = operation.strip_prefix(INVERTED).unwrap_or(operation);
        let Some(sampled) = prim.value(name)? else { continue };
        transform.is_animated |= sampled.is_animated;
        let kind = name.strip_prefix(NAMESPACE).unwrap_or(name).split(':').next().unwrap_or_default();
        let matrix = operation_matrix(kind, &sampled.value)
            .ok_or_else(|| format!("{name}: its value is no transform"))?;
        let matrix = match name == operation {
            true => matrix,
            false => matrix.try_inverse().ok_or_else(|| format!("{operation}: cannot be inverted"))?,
        };
        if !matrix.iter().all(|x| x.is_finite()) {
            return Err(format!("{operation}: has a number that is not finite"));
        }
        transform.matrix *= matrix;
    }
    Ok(transform)
}

/// Returns the matrix of an operation; `None` for a kind that is not known or a value that does not fit it.
fn operation_matrix(kind: &str, value: &UsdValue) -> Option<Mat4> {
    let number = || match value {
        UsdValue::Number(x) => Some(*x),
        _ => None,
    };
    let components = || match value {
        UsdValue::Components(all) => Some(all.as_slice()),
        _ => None,
    };
    let vector = || components().and_then(|all| <[f64; 3]>::try_from(all).ok()).map(Vec3::from);
    let axis = |letter: u8| [Vec3::x_axis(), Vec3::y_axis(), Vec3::z_axis()][usize::from(letter - b'X')];
    let rotation = |letter: u8, degrees: f64| {
        Rotation3::from_axis_angle(&axis(letter), degrees.to_radians()).to_homogeneous()
    };
    let letters = kind.as_bytes();
    Some(match kind {
        "translate" => Mat4::new_translation(&vector()?),
        "scale" => Mat4::new_nonuniform_scaling(&vector()?),
        "translateX" | "translateY" | "translateZ" => {
            Mat4::new_translation(&(axis(letters[9]).scale(number()?)))
        }
        "scaleX" | "scaleY" | "scaleZ" => {
            let along = axis(letters[5]).into_inner();
            Mat4::new_nonuniform_scaling(&(Vec3::repeat(1.0) + along * (number()? - 1.0)))
        }
        "rotateX" | "rotateY" | "rotateZ" => rotation(letters[6], number()?),
        "rotateXYZ" | "rotateXZY" | "rotateYXZ" | "rotateYZX" | "rotateZXY" | "rotateZYX" => {
            let degrees = vector()?;
            let [first, second, third] =
                [6, 7, 8].map(|k| rotation(letters[k], degrees[usize::from(letters[k] - b'X')]));
            third * second * first
        }
        "orient" => {
            let [w, x, y, z] = <[f64; 4]>::try_from(components()?).ok()?;
            UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE)?.to_homogeneous()
        }
        "transform" => Mat4::from_column_slice(&<[f64; 16]>::try_from(components()?).ok()?),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(kind: &str, value: UsdValue) -> [f64; 3] {
        let point = operation_matrix(kind, &value).expect("a transform") * Vec3::new(1.0, 2.0, 3.0).push(1.0);
        [point.x, point.y, point.z].map(|x| (x * 1e9).round() / 1e9)
    }

    #[test]
    fn operations_are_those_of_usd() {
        let vector = |x, y, z| UsdValue::Components(vec![x, y, z]);
        assert_eq!(moved("translate", vector(1.0, 0.0, -1.0)), [2.0, 2.0, 2.0]);
        assert_eq!(moved("translateY", UsdValue::Number(5.0)), [1.0, 7.0, 3.0]);
        assert_eq!(moved("scaleZ", UsdValue::Number(2.0)), [1.0, 2.0, 6.0]);
        assert_eq!(moved("rotateZ", UsdValue::Number(90.0)), [-2.0, 1.0, 3.0]);
        // First about x, then about z: the order of the letters, checked against UsdGeom.Xformable.
        assert_eq!(moved("rotateXYZ", vector(90.0, 0.0, 90.0)), [3.0, 1.0, 2.0]);
        assert_eq!(moved("rotateZYX", vector(90.0, 0.0, 90.0)), [-2.0, -3.0, 1.0]);
        let half = 0.5f64.sqrt();
        assert_eq!(moved("orient", UsdValue::Components(vec![half, 0.0, 0.0, half])), [-2.0, 1.0, 3.0]);
        let mut rows = vec![0.0; 16];
        (rows[1], rows[4], rows[10], rows[15], rows[12]) = (1.0, -1.0, 1.0, 1.0, 7.0);
        assert_eq!(moved("transform", UsdValue::Components(rows)), [5.0, 1.0, 3.0]);
    }

    #[test]
    fn values_that_do_not_fit_are_no_transforms() {
        for (kind, value) in [
            ("translate", UsdValue::Number(1.0)),
            ("orient", UsdValue::Components(vec![0.0; 4])),
            ("transform", UsdValue::Components(vec![1.0; 3])),
            ("skew", UsdValue::Number(1.0)),
            ("", UsdValue::Other),
        ] {
            assert!(operation_matrix(kind, &value).is_none(), "{kind}");
        }
    }
}
