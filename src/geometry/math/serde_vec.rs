//! Vectors and matrices as plain lists of numbers, for files written through serde (checkpoints):
//! `#[serde(with = "crate::math::serde_vec::vector")]` on a field. JSON keeps every finite number bit for bit; numbers
//! that are not finite are refused when they are read back.

/// A vector as `[x, y, z]`.
pub mod vector {
    use crate::math::Vec3;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a vector.
    pub fn serialize<S: Serializer>(v: &Vec3, out: S) -> Result<S::Ok, S::Error> {
        [v.x, v.y, v.z].serialize(out)
    }

    /// Reads a vector.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec3, D::Error> {
        <[f64; 3]>::deserialize(from).map(Vec3::from)
    }
}

/// A list of vectors as `[[x, y, z], ...]`.
pub mod vectors {
    use crate::math::Vec3;
    use serde::{Deserialize, Deserializer, Serializer};

    /// Writes a list of vectors.
    pub fn serialize<S: Serializer>(list: &[Vec3], out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(list.iter().map(|v| [v.x, v.y, v.z]))
    }

    /// Reads a list of vectors.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Vec3>, D::Error> {
        Ok(Vec::<[f64; 3]>::deserialize(from)?.into_iter().map(Vec3::from).collect())
    }
}

/// A matrix as its three rows.
pub mod matrix {
    use crate::math::Mat3;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a matrix.
    pub fn serialize<S: Serializer>(m: &Mat3, out: S) -> Result<S::Ok, S::Error> {
        [0, 1, 2].map(|r| [m[(r, 0)], m[(r, 1)], m[(r, 2)]]).serialize(out)
    }

    /// Reads a matrix.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Mat3, D::Error> {
        <[[f64; 3]; 3]>::deserialize(from).map(|rows| Mat3::from_fn(|r, c| rows[r][c]))
    }
}

/// A limit that may be infinite, written as null then.
pub mod limit {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a limit.
    pub fn serialize<S: Serializer>(x: &f64, out: S) -> Result<S::Ok, S::Error> {
        Some(*x).filter(|x| *x < f64::INFINITY).serialize(out)
    }

    /// Reads a limit.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}
