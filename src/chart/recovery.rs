//! `crease chart recovery`: crease recovery angles of all presets, compared with published ranges.
//!
//! The protocol of ISO 2313: a strip of 40 x 15 mm is folded end to end, pressed with 10 N for 300 s, released within
//! 1 s, and the angle between its limbs is measured 300 s later, without gravity (the free limb is kept upright). 180
//! degrees is full recovery. Holds of 30 and 3000 s and readings at 5 s and 1 h show the dependence on time. The
//! published ranges are typical ones of the fibre, one direction; `docs/reference/fabrics.md` cites the measurements behind
//! them and says where none was found.

use crate::press_between_plates::PlatePress;
use crate::{Axis, BLACK, Chart, ChartOptions, Figure, GREY, Mark, Panel, Series, Table};
use crease_model::error::Result;
use crease_model::fabric::Fabric;

/// Length of the strip [m].
const LENGTH: f64 = 0.04;
/// Width of the strip [m].
const WIDTH: f64 = 0.015;
/// Force on the fold [N].
const FORCE: f64 = 10.0;
/// Spacing of the mesh's lines [m].
const ELEMENT: f64 = 0.005;
/// Times under load [s]; the standard's is the second.
const HOLDS: [f64; 3] = [30.0, 300.0, 3000.0];
/// Times after release [s]; the standard's is the second.
const READINGS: [f64; 3] = [5.0, 300.0, 3600.0];

/// Recovery angles of the fibre of a preset, in one direction [degrees].
struct Published {
    preset: &'static str,
    /// Typical range; the measurements lie in it.
    range: [f64; 2],
    /// Measurements of the literature, cited in `docs/reference/fabrics.md`; none where no paper with numbers was found.
    measured: &'static [f64],
}

/// Cotton without finish: half the sum of warp and weft, Dhiman and Chakraborty 2017, table 13.
const COTTON: &[f64] = &[77.5];
/// Crosslinked cellulose: cotton with DMDHEU, the lowest and highest of table 13 of the same; lyocell with BTCA at most.
const RESIN: &[f64] = &[99.5, 118.0, 147.0];
/// Silk without finish: half the sum of warp and weft, Yang and Li 1993.
const SILK: &[f64] = &[132.5];

const PUBLISHED: &[Published] = &[
    Published { preset: "linen", range: [45.0, 75.0], measured: &[] },
    Published { preset: "viscose-challis", range: [60.0, 100.0], measured: &[] },
    Published { preset: "cotton-poplin", range: [60.0, 92.0], measured: COTTON },
    Published { preset: "denim", range: [60.0, 92.0], measured: COTTON },
    Published { preset: "cotton-jersey", range: [60.0, 92.0], measured: COTTON },
    Published { preset: "cotton-poplin-resin", range: [99.0, 147.0], measured: RESIN },
    Published { preset: "silk-habotai", range: [105.0, 140.0], measured: SILK },
    Published { preset: "polycotton-shirting", range: [110.0, 140.0], measured: &[] },
    Published { preset: "interlock-ponte", range: [110.0, 140.0], measured: &[] },
    Published { preset: "wool-summer-suiting", range: [140.0, 168.0], measured: &[] },
    Published { preset: "wool-winter-flannel", range: [140.0, 168.0], measured: &[] },
    Published { preset: "polyester-georgette", range: [130.0, 165.0], measured: &[] },
    Published { preset: "polyester-taffeta", range: [130.0, 165.0], measured: &[] },
];

/// Published range of a preset [degrees]; `None` where none is known.
pub fn published(fabric: &str) -> Option<[f64; 2]> {
    PUBLISHED.iter().find(|known| known.preset == fabric).map(|known| known.range)
}

/// Recovery angles [degrees] of `fabric` after `hold` [s] under load, at the times `readings` after release [s,
/// ascending], on a mesh with lines every `element` [m] whose middle line is the fold.
pub fn recovery_angles(fabric: &Fabric, element: f64, hold: f64, readings: &[f64]) -> Vec<f64> {
    let gap = PlatePress::gap_under(fabric, FORCE / WIDTH);
    let press = PlatePress { length: LENGTH, width: WIDTH, gap, element, offset: 0.0 };
    let mut strip = press.hold(fabric, hold);
    let read = |at: &f64| {
        strip.wait_until(*at);
        180.0 - strip.crease_angle().to_degrees()
    };
    readings.iter().map(read).collect()
}

pub(super) fn make(_options: &ChartOptions) -> Result<Chart> {
    let mut table =
        Table::new(&["fabric", "hold_s", "read_s", "angle_deg", "published_low_deg", "published_high_deg"]);
    let names = Fabric::preset_names();
    let mut series = vec![
        Series::new("published range, read after 300 s", GREY, Mark::Bars, Vec::new()),
        Series::new("held 30 s", 4, Mark::Dots, Vec::new()),
        Series::new("held 300 s", 1, Mark::Dots, Vec::new()),
        Series::new("held 3000 s", 0, Mark::Dots, Vec::new()),
        Series::new("held 300 s, read after 5 s and after 1 h", BLACK, Mark::Line, Vec::new()),
        Series::new("measurements cited", 2, Mark::Dots, Vec::new()),
    ];
    let mut spans = Vec::new();
    let mut inside = 0;
    let mut known = 0;
    for (row, name) in names.iter().rev().enumerate() {
        let row = row as f64;
        let fabric = Fabric::preset(name)?;
        let range = published(name);
        let measured =
            PUBLISHED.iter().filter(|known| known.preset == *name).flat_map(|known| known.measured);
        series[5].points.extend(measured.map(|angle| [*angle, row]));
        if let Some([low, high]) = range {
            series[0].points.extend([[low, row], [high, row]]);
        }
        for (number, hold) in HOLDS.into_iter().enumerate() {
            let angles = recovery_angles(&fabric, ELEMENT, hold, &READINGS);
            for (read, angle) in READINGS.into_iter().zip(&angles) {
                // The ranges refer to the times of the standard.
                let range = range.filter(|_| hold == HOLDS[1] && read == READINGS[1]);
                known += u32::from(range.is_some());
                inside += u32::from(range.is_some_and(|[low, high]| (low..=high).contains(angle)));
                let [low, high] = [0, 1].map(|k| range.map(|r| r[k]).into());
                table.push([(*name).into(), hold.into(), read.into(), (*angle).into(), low, high]);
            }
            series[1 + number].points.push([angles[1], row]);
            if hold == HOLDS[1] {
                spans.push(vec![[angles[0], row], [angles[2], row]]);
            }
        }
    }
    series.extend(spans.into_iter().map(|span| Series::new("", BLACK, Mark::Line, span)));
    // Dots over lines.
    series.sort_by_key(|s| (s.mark == Mark::Dots, s.mark == Mark::Line));
    let y = Axis { names: names.iter().rev().map(|n| (*n).to_owned()).collect(), ..Axis::default() };
    let count = names.len() as f64;
    Ok(Chart {
        name: "recovery",
        table,
        figure: Figure {
            title: "Crease recovery of a strip pressed in a fold (ISO 2313)".into(),
            panels: vec![Panel {
                title: String::new(),
                x: Axis::linear("recovery angle [degrees], 180 = full recovery").between(0.0, 180.0),
                y: y.between(-0.7, count - 0.3),
                series,
            }],
        },
        notes: vec![
            format!("{inside} of {known} fabrics with a published range lie inside it (held 300 s, read after 300 s)"),
            "published ranges are typical values of the fibre, one direction, around the measurements that docs/reference/fabrics.md \
             cites; kow-tshirt is the paper's fabric and has none"
                .into(),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All thirteen presets with a published range; longer holds leave sharper creases, longer waiting opens them.
    #[test]
    fn every_fabric_recovers_within_the_range_of_its_fibre_and_in_the_order_of_holds() {
        for Published { preset: name, range: [low, high], measured } in PUBLISHED {
            let fabric = Fabric::preset(name).expect(name);
            let [short, standard, long] =
                HOLDS.map(|hold| recovery_angles(&fabric, ELEMENT, hold, &READINGS));
            println!("{name:<22} {short:.1?} {standard:.1?} {long:.1?}, published {low} to {high}");
            assert!((*low..=*high).contains(&standard[1]), "{name}: {}", standard[1]);
            assert!(measured.iter().all(|m| (*low..=*high).contains(m)), "{name}: {measured:?}");
            let nearest = measured.iter().map(|m| (m - standard[1]).abs()).reduce(f64::min);
            assert!(
                nearest.is_none_or(|distance| distance < 8.0),
                "{name}: {} and {measured:?}",
                standard[1]
            );
            for at in 0..READINGS.len() {
                assert!(short[at] > standard[at] + 2.0 && standard[at] > long[at] + 2.0, "{name}");
            }
            for angles in [&short, &standard, &long] {
                assert!(angles.is_sorted() && angles[2] > angles[0] + 1.0, "{name}: {angles:?}");
            }
        }
    }

    /// Folds are narrower than the elements: on meshes no finer than the fabrics' reference length the angle is the
    /// same up to single events.
    #[test]
    fn angles_depend_little_on_the_mesh() {
        for Published { preset: name, .. } in PUBLISHED {
            let fabric = Fabric::preset(name).expect(name);
            let angles = [0.010, 0.005, 0.0025].map(|w| recovery_angles(&fabric, w, 300.0, &[300.0])[0]);
            let [low, high] = [f64::min, f64::max].map(|pick| angles.into_iter().reduce(pick).unwrap_or(0.0));
            println!("{name:<22} 10, 5, 2.5 mm: {angles:.1?}");
            assert!(high - low < 20.0, "{name}: {angles:?}");
        }
    }

    #[test]
    fn without_recovery_over_time_the_paper_s_fabric_keeps_its_angle() {
        let fabric = Fabric::preset("kow-tshirt").expect("exists");
        let angles = recovery_angles(&fabric, ELEMENT, 300.0, &READINGS);
        assert!(angles[0] == angles[1] && angles[1] == angles[2], "{angles:?}");
        assert_eq!(published("kow-tshirt"), None);
    }
}
