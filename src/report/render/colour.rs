//! Colour maps of fields, and conversion between linear light and sRGB.
//!
//! The sequential map is viridis (CC0) by eleven equidistant stops; the diverging map runs from blue through pale grey to
//! orange. Their lightness is monotonic (from the middle outwards) for all common kinds of colour blindness.

/// Colour map of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourMap {
    /// Sequential: dark violet at the minimum to yellow at the maximum.
    Sequential,
    /// Around zero: blue below, orange above, pale grey at zero.
    Diverging,
}

/// Background of a picture, sRGB.
pub(super) const BACKGROUND_SRGB: [u8; 3] = [238, 238, 238];

const SEQUENTIAL: [[u8; 3]; 11] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x24, 0x75],
    [0x41, 0x44, 0x87],
    [0x35, 0x5f, 0x8d],
    [0x2a, 0x78, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x22, 0xa8, 0x84],
    [0x44, 0xbf, 0x70],
    [0x7a, 0xd1, 0x51],
    [0xbd, 0xdf, 0x26],
    [0xfd, 0xe7, 0x25],
];

const DIVERGING: [[u8; 3]; 7] = [
    [12, 44, 110],
    [38, 98, 176],
    [128, 176, 220],
    [236, 236, 234],
    [238, 172, 104],
    [206, 98, 20],
    [118, 44, 2],
];

/// Colour of missing values.
pub(super) const MISSING: [u8; 3] = [150, 150, 150];

impl ColourMap {
    /// Returns the colour at a `fraction` of the range, 0 to 1, as sRGB; grey for NaN.
    pub fn srgb(self, fraction: f64) -> [u8; 3] {
        if fraction.is_nan() {
            return MISSING;
        }
        let stops: &[[u8; 3]] = match self {
            Self::Sequential => &SEQUENTIAL,
            Self::Diverging => &DIVERGING,
        };
        let position = fraction.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let i = (position as usize).min(stops.len() - 2);
        let t = position - i as f64;
        let (a, b) = (stops[i], stops[i + 1]);
        std::array::from_fn(|k| (f64::from(a[k]) + t * (f64::from(b[k]) - f64::from(a[k]))).round() as u8)
    }

    /// Returns the same colour in linear light, 0 to 1.
    pub(super) fn linear(self, fraction: f64) -> [f64; 3] {
        self.srgb(fraction).map(|c| to_linear(f64::from(c) / 255.0))
    }
}

/// Converts sRGB to linear light, both 0 to 1.
pub(super) fn to_linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Converts linear light, 0 to 1, to an sRGB byte.
pub(super) fn to_srgb(c: f64) -> u8 {
    let c = c.clamp(0.0, 1.0);
    let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (255.0 * s).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(c: [u8; 3]) -> f64 {
        let [r, g, b] = c.map(|c| to_linear(f64::from(c) / 255.0));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// The order is visible even without any hue.
    #[test]
    fn lightness_is_monotonic() {
        for k in 0..100 {
            let (a, b) = (f64::from(k) / 100.0, f64::from(k + 1) / 100.0);
            let map = ColourMap::Sequential;
            assert!(lightness(map.srgb(b)) >= lightness(map.srgb(a)), "at {a}");
            let map = ColourMap::Diverging;
            let rises = lightness(map.srgb(b)) >= lightness(map.srgb(a));
            assert!(rises == (k < 50), "at {a}");
        }
    }

    #[test]
    fn conversions_are_inverse_and_nan_is_grey() {
        for c in 0..=255u8 {
            assert_eq!(to_srgb(to_linear(f64::from(c) / 255.0)), c);
        }
        assert_eq!(ColourMap::Diverging.srgb(f64::NAN), MISSING);
        assert_eq!(ColourMap::Sequential.srgb(7.0), [0xfd, 0xe7, 0x25]);
    }
}
