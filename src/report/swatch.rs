//! Swatches: the fabrics on one page, each drawn as it would hang over the edge of a table.
//!
//! The strip is the heavy elastica that Peirce measured cloth with: with c the bending length, s along a strip of
//! length L from the edge and theta below the horizontal,
//!
//! ```text
//! theta'' = -(L - s) cos(theta) / c³,   theta(0) = 0,   theta'(L) = 0
//! ```
//!
//! solved by shooting for theta'(0). It shows the drape, not the colour, which is nobody's knowledge here.

use super::viewer::escaped;
use crate::fabric::Fabric;
use std::fmt::Write;

/// Length of the strip that hangs over [m].
const STRIP_M: f64 = 0.12;
/// Pieces of the strip in a picture.
const PIECES: usize = 120;

/// Points [m] of a strip of `length` [m] whose cloth has the bending length `c` [m], x outward, y down, from the edge.
pub fn overhang(length: f64, c: f64) -> Vec<[f64; 2]> {
    let h = length / PIECES as f64;
    // (theta, theta') by the classical Runge-Kutta method; where it ends tells whether the start was steep enough.
    let shoot = |first: f64| {
        let slope = |s: f64, [theta, rate]: [f64; 2]| [rate, -(length - s) * theta.cos() / c.powi(3)];
        let mut y = [0.0, first];
        let mut thetas = vec![0.0];
        for k in 0..PIECES {
            let s = k as f64 * h;
            let ahead = |d: [f64; 2], by: f64| [y[0] + by * d[0], y[1] + by * d[1]];
            let k1 = slope(s, y);
            let k2 = slope(s + 0.5 * h, ahead(k1, 0.5 * h));
            let k3 = slope(s + 0.5 * h, ahead(k2, 0.5 * h));
            let k4 = slope(s + h, ahead(k3, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            thetas.push(y[0]);
        }
        (thetas, y[1])
    };
    // A strip ends straight; it starts no steeper than if all its weight hung at right angles.
    let (mut low, mut high) = (0.0, 0.5 * length * length / c.powi(3));
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if shoot(middle).1 > 0.0 { high = middle } else { low = middle }
    }
    let (thetas, _) = shoot(0.5 * (low + high));
    let mut place = [0.0, 0.0];
    let mut points = vec![place];
    for pair in thetas.windows(2) {
        let theta = 0.5 * (pair[0] + pair[1]).clamp(-4.0, 4.0);
        place = [place[0] + h * theta.cos(), place[1] + h * theta.sin()];
        points.push(place);
    }
    points
}

/// The page.
pub fn swatch_page(fabrics: &[Fabric]) -> String {
    let mut cards = String::new();
    for fabric in fabrics {
        let path: Vec<String> = overhang(STRIP_M, fabric.bending_length())
            .iter()
            .map(|[x, y]| format!("{:.2},{:.2}", 60.0 + 1e3 * x, 20.0 + 1e3 * y))
            .collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            cards,
            "<article><svg viewBox=\"0 0 200 150\" role=\"img\" aria-label=\"a strip over an edge\"><rect x=\"0\" y=\"20\" \
             width=\"60\" height=\"130\" fill=\"#d8d5ce\"/><polyline points=\"0,20 {}\" fill=\"none\" stroke=\"#2f5d8a\" \
             stroke-width=\"{:.2}\" stroke-linecap=\"round\"/></svg><h2>{}</h2><p>{}</p><p>{:.0} g/m², bending length \
             {:.1} mm, {:.2} mm thick</p></article>",
            path.join(" "),
            1.0 + 2.0 * 1e3 * fabric.thickness(),
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
        1e3 * STRIP_M
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peirce: cloth that hangs over by 2^(1/3)... of its bending length in his measure droops by 41.5 degrees. With
    /// c³ = B / w that length is c (8 tan / cos)^(1/3) at 41.5 degrees, by his approximation, good to 2 %.
    #[test]
    fn a_strip_droops_as_peirce_found() {
        let c = 0.02;
        let angle = 41.5_f64.to_radians();
        let length = c * (8.0 * angle.tan() / (0.5 * angle).cos()).cbrt();
        let [x, y] = *overhang(length, c).last().expect("an end");
        let droop = y.atan2(x).to_degrees();
        assert!((droop - 41.5).abs() < 1.5, "{droop}");
    }

    #[test]
    fn stiff_cloth_stands_out_and_limp_cloth_hangs_down() {
        let end = |c: f64| *overhang(STRIP_M, c).last().expect("an end");
        assert!(end(1.0)[1] < 1e-3 && end(1.0)[0] > 0.119);
        assert!(end(0.012)[1] > 0.09 && end(0.012)[0] > 0.0);
        let length: f64 =
            overhang(STRIP_M, 0.02).windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
        assert!((length - STRIP_M).abs() < 1e-9, "{length}");
    }

    #[test]
    fn every_fabric_has_its_place() {
        let fabrics: Vec<Fabric> =
            Fabric::preset_names().iter().map(|name| Fabric::preset(name).expect("a preset")).collect();
        let page = swatch_page(&fabrics);
        assert_eq!(page.matches("<article>").count(), fabrics.len());
        assert!(!page.contains("NaN") && !page.contains("inf"));
    }
}
