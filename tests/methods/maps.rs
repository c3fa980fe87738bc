//! The maps of `crease chart stability`, cell by cell for the methods that promise something.

use crease::chart::stability::{MAPS, MethodColumn, Verdict};
use crease::sim::Method;

/// Runs every cell of the map `name` by `method`; the outcomes, and the worst strain.
fn cells(name: &str, method: MethodColumn) -> Vec<(f64, f64, Verdict)> {
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
            all.push((value, step, cell.verdict));
        }
    }
    all
}

/// Promise: what a bake does unless told otherwise fails no cell of any map.
fn default_fails_nowhere(name: &str) {
    let failed: Vec<_> =
        cells(name, MethodColumn::Default).into_iter().filter(|c| c.2 == Verdict::Failed).collect();
    assert!(failed.is_empty(), "{name}: {failed:?}");
}

#[test]
fn default_method_stands_stiff_cloth() {
    default_fails_nowhere("release90");
}

#[test]
fn default_method_stands_contrast() {
    default_fails_nowhere("contrast");
}

#[test]
fn default_method_stands_slivers() {
    default_fails_nowhere("sliver");
}

#[test]
fn default_method_stands_layers() {
    default_fails_nowhere("layers");
}

#[test]
fn default_method_stands_speed() {
    default_fails_nowhere("approach");
}

/// Promise: the map shows where others fail or go wrong: one iteration is not right anywhere at 1/24 s on the whipping
/// strip, and sweeps are not right on any stiff one.
#[test]
fn the_map_shows_where_others_go_wrong() {
    let wrong = |method, step: f64, from: f64| {
        cells("release90", MethodColumn::Method(method))
            .into_iter()
            .filter(|c| c.1 >= step && c.0 >= from)
            .all(|c| c.2 != Verdict::Converged)
    };
    assert!(wrong(Method::BackwardEulerOnce, 1.0 / 24.0, 0.0));
    assert!(wrong(Method::VertexBlockDescent, 0.0, 2e4));
}
