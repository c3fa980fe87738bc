//! Filters of `EXT_meshopt_compression` (specification, appendix B), undone in place: unit vectors on an octahedron, unit
//! quaternions without their largest component, numbers with shared exponents.

/// Undoes the filter `name` in elements of `stride` bytes; `None` for one that does not exist or does not fit.
pub(super) fn undo_filter(name: &str, stride: usize, data: &mut [u8]) -> Option<()> {
    match (name, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => data.as_chunks_mut::<4>().0.iter_mut().for_each(|element| {
            let row = element.map(|byte| f64::from(byte.cast_signed()));
            let unit = octahedral(row, 127.0);
            (0..3).for_each(|k| element[k] = (unit[k] as i8).cast_unsigned());
        }),
        ("OCTAHEDRAL", 8) => data.as_chunks_mut::<8>().0.iter_mut().for_each(|element| {
            let unit = octahedral(words(element).map(f64::from), 32_767.0);
            (0..3).for_each(|k| element[2 * k..2 * k + 2].copy_from_slice(&(unit[k] as i16).to_le_bytes()));
        }),
        ("QUATERNION", 8) => data.as_chunks_mut::<8>().0.iter_mut().for_each(|element| {
            let rotation = quaternion(words(element));
            (0..4)
                .for_each(|k| element[2 * k..2 * k + 2].copy_from_slice(&(rotation[k] as i16).to_le_bytes()));
        }),
        ("EXPONENTIAL", stride) if stride.is_multiple_of(4) => {
            data.as_chunks_mut::<4>().0.iter_mut().for_each(|element| {
                let bits = i32::from_le_bytes(*element);
                let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
                *element = ((f64::from(mantissa) * f64::from(exponent).exp2()) as f32).to_le_bytes();
            });
        }
        _ => return None,
    }
    Some(())
}

fn words(element: &[u8; 8]) -> [i16; 4] {
    [0, 1, 2, 3].map(|k| i16::from_le_bytes([element[2 * k], element[2 * k + 1]]))
}

/// Unit vector times `scale`, rounded, from its place on an octahedron: x, y and the size of one.
fn octahedral([x, y, one, _]: [f64; 4], scale: f64) -> [f64; 3] {
    let one = if one == 0.0 { 1.0 } else { one };
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded over the upper one.
    let fold = (-z).max(0.0);
    let folded = |x: f64| if x >= 0.0 { x - fold } else { x + fold };
    let v = [folded(x), folded(y), z];
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    v.map(|x| (x / length * scale).round())
}

/// Quaternion as 16-bit fractions, rounded, from three components, the size of one and the place of the largest component.
fn quaternion([a, b, c, last]: [i16; 4]) -> [f64; 4] {
    let (one, largest) = (f64::from(last | 3), (last & 3) as usize);
    let [x, y, z] = [a, b, c].map(|v| f64::from(v) / one * std::f64::consts::FRAC_1_SQRT_2);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut out = [0.0; 4];
    for (k, value) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + k) % 4] = (value * 32_767.0).round();
    }
    out
}
