//! The maps of `crease chart stability`, cell by cell for the integrators with documented properties.

use crease_chart::comparison::{BACKWARD_EULER_ONCE, VERTEX_BLOCK_DESCENT};
use crease_chart::stability::{MAPS, MethodColumn, Verdict};

/// Verdict on one cell.
#[derive(Debug)]
struct CellVerdict {
    /// Value of the map's parameter.
    value: f64,
    /// Step size [s].
    step: f64,
    verdict: Verdict,
}

/// Runs every cell of the map `name` with `method`.
fn cells(name: &str, method: MethodColumn) -> Vec<CellVerdict> {
    let map = MAPS.iter().find(|map| map.name == name).expect("is on the list");
    let mut all = Vec::new();
    for &value in map.values {
        let reference = map.reference(value).expect("the scene can be made");
        for &step in map.steps {
            let cell = map.cell(value, method, step, &reference).expect("the scene can be made");
            println!(
                "{name} {value} {:.1} ms {}: {} (error {:.3}, strain {:.4}, {} solves{})",
                1e3 * step,
                method.name(),
                cell.verdict.name(),
                cell.error,
                cell.max_strain,
                cell.linear_solves,
                cell.why.map_or(String::new(), |why| format!(", {why}"))
            );
            all.push(CellVerdict { value, step, verdict: cell.verdict });
        }
    }
    all
}

/// Property: the default of a bake fails in no cell of any map.
fn default_fails_nowhere(name: &str) {
    let failed: Vec<_> =
        cells(name, MethodColumn::Default).into_iter().filter(|c| c.verdict == Verdict::Failed).collect();
    assert!(failed.is_empty(), "{name}: {failed:?}");
}

#[test]
fn default_method_survives_stiff_cloth() {
    default_fails_nowhere("release90");
}

#[test]
fn default_method_survives_contrast() {
    default_fails_nowhere("contrast");
}

#[test]
fn default_method_survives_slivers() {
    default_fails_nowhere("sliver");
}

#[test]
fn default_method_survives_layers() {
    default_fails_nowhere("layers");
}

#[test]
fn default_method_survives_speed() {
    default_fails_nowhere("approach");
}

/// Property: the map shows failures and inaccuracies of the others: one iteration never converges at 1/24 s on the
/// whipping strip, and vertex block descent never on a stiff one.
#[test]
fn the_map_shows_failures_of_other_methods() {
    let wrong = |method, step: f64, from: f64| {
        cells("release90", MethodColumn::Method(method))
            .into_iter()
            .filter(|c| c.step >= step && c.value >= from)
            .all(|c| c.verdict != Verdict::Converged)
    };
    assert!(wrong(BACKWARD_EULER_ONCE, 1.0 / 24.0, 0.0));
    assert!(wrong(VERTEX_BLOCK_DESCENT, 0.0, 2e4));
}
