//! Swatches: fabrics on one page, each drawn as a strip that hangs over the edge of a table.
//!
//! The strip is the heavy elastica of Peirce's cantilever test: with c the bending length, t along a strip of
//! length L from its free end and phi the angle to the plumb line,
//!
//! ```text
//! phi'' = t sin(phi) / c³,   phi'(0) = 0,   phi(L) = 90 degrees
//! ```
//!
//! solved by shooting for phi(0). Swatches show the drape of a fabric, not its colour.

use crate::report::html::escaped;
use crease_model::fabric::Fabric;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Length of the strip [m].
const STRIP_LENGTH_M: f64 = 0.05;
/// Drawing units per metre.
const UNITS_PER_METRE: f64 = 2400.0;
/// Segments of the strip.
const SEGMENTS: usize = 120;

/// Returns the points of a hanging strip [m], from the edge on: x outward, y down. `length` is that of the strip [m], `c` the
/// bending length of its cloth [m].
pub fn overhang(length: f64, c: f64) -> Vec<[f64; 2]> {
    let h = length / SEGMENTS as f64;
    // phi at every node from the free end on, by the classical Runge-Kutta method; stops where phi exceeds 90 degrees.
    let shoot = |beta: f64| {
        let slope = |t: f64, [phi, rate]: [f64; 2]| [rate, t * phi.sin() / c.powi(3)];
        let mut y = [beta, 0.0];
        let mut phis = vec![beta];
        for k in 0..SEGMENTS {
            let t = k as f64 * h;
            let ahead = |d: [f64; 2], by: f64| [y[0] + by * d[0], y[1] + by * d[1]];
            let k1 = slope(t, y);
            let k2 = slope(t + 0.5 * h, ahead(k1, 0.5 * h));
            let k3 = slope(t + 0.5 * h, ahead(k2, 0.5 * h));
            let k4 = slope(t + h, ahead(k3, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            phis.push(y[0].min(FRAC_PI_2));
            if y[0] > FRAC_PI_2 {
                break;
            }
        }
        phis
    };
    // Bisection of the logarithm: the free end of limp cloth deviates from the vertical by as little as 1e-9 degrees.
    let (mut low, mut high) = (-200.0_f64, FRAC_PI_2.ln());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let beyond = shoot(middle.exp()).last().is_some_and(|phi| *phi >= FRAC_PI_2);
        if beyond { high = middle } else { low = middle }
    }
    let mut phis = shoot(low.exp());
    phis.reverse();
    let mut position = [0.0, 0.0];
    let mut points = vec![position];
    for pair in phis.windows(2) {
        let phi = 0.5 * (pair[0] + pair[1]);
        position = [position[0] + h * phi.sin(), position[1] + h * phi.cos()];
        points.push(position);
    }
    points
}

/// Returns the page of `fabrics`.
///
/// ```
/// let page = crease::picture::swatch_page(&[crease::Fabric::preset("denim")?]);
/// assert!(page.contains("denim"));
/// # Ok::<(), crease::Error>(())
/// ```
pub fn swatch_page(fabrics: &[Fabric]) -> String {
    let mut cards = String::new();
    for fabric in fabrics {
        let path: Vec<String> = overhang(STRIP_LENGTH_M, fabric.bending_length())
            .iter()
            .map(|[x, y]| format!("{:.2},{:.2}", 60.0 + UNITS_PER_METRE * x, 20.0 + UNITS_PER_METRE * y))
            .collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            cards,
            "<article><svg viewBox=\"0 0 200 150\" role=\"img\" aria-label=\"a strip over an edge\"><rect x=\"0\" y=\"20\" \
             width=\"60\" height=\"130\" fill=\"#d8d5ce\"/><polyline points=\"0,20 {}\" fill=\"none\" stroke=\"#2f5d8a\" \
             stroke-width=\"{:.2}\" stroke-linecap=\"round\"/></svg><h2>{}</h2><p>{}</p><p>{:.0} g/m², bending length \
             {:.1} mm, {:.2} mm thick</p></article>",
            path.join(" "),
            UNITS_PER_METRE * fabric.thickness(),
            escaped(&fabric.name),
            escaped(&fabric.description),
            fabric.area_density_g_m2,
            1e3 * fabric.bending_length(),
            1e3 * fabric.thickness(),
        );
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>crease fabrics</title><style>\
         body{{font:14px/1.4 system-ui,sans-serif;background:#f4f3f0;color:#28292e;margin:1.5em}}\
         main{{display:flex;flex-wrap:wrap;gap:1em}}article{{width:230px;background:#fff;border:1px solid #ddd;\
         padding:.6em}}h1{{font-size:1.3em}}h2{{font-size:1em;margin:.2em 0}}p{{margin:.2em 0}}</style></head>\n\
         <body><h1>Fabrics, each as a strip of {:.0} mm hangs over an edge</h1>\n<main>\n{cards}</main></body></html>\n",
        1e3 * STRIP_LENGTH_M
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chord angle of the overhang against L³ / c³, from an independent solution of the same equation.
    #[test]
    fn a_strip_droops_as_the_heavy_elastica_does() {
        let c = 0.02;
        for (degrees, gamma) in [(5.0, 0.701_129), (20.0, 2.994_369_8), (30.0, 4.920_939_53), (41.5, 8.0042)]
        {
            let [x, y] = *overhang(c * f64::cbrt(gamma), c).last().expect("an end");
            let droop = y.atan2(x).to_degrees();
            assert!((droop - degrees).abs() < 0.02, "{droop} instead of {degrees}");
        }
    }

    #[test]
    fn stiff_cloth_stands_out_and_limp_cloth_hangs_down() {
        let length = 0.12;
        let end = |c: f64| *overhang(length, c).last().expect("an end");
        assert!(end(1.0)[1] < 1e-3 && end(1.0)[0] > 0.119);
        assert!(end(0.012)[1] > 0.09 && end(0.012)[0] > 0.0);
        let along: f64 =
            overhang(length, 0.02).windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
        assert!((along - length).abs() < 1e-9, "{along}");
    }

    #[test]
    fn every_fabric_is_on_the_page() {
        let fabrics: Vec<Fabric> =
            Fabric::preset_names().iter().map(|name| Fabric::preset(name).expect("a preset")).collect();
        let page = swatch_page(&fabrics);
        assert_eq!(page.matches("<article>").count(), fabrics.len());
        assert!(!page.contains("NaN") && !page.contains("inf"));
    }
}
