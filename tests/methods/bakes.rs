//! Cells of `crease chart robustness` at default quality: the difficult ends of its quick maps.

use crease::internal::bake::Quality;
use crease_chart::robustness::{Column, MAPS, Outcome};

/// Property: a doll's sheet, felt of 3 mm and a press of 20 kPa are baked without a warning.
#[test]
fn bakes_where_they_get_difficult_are_sound() {
    for (name, value) in [("size", 0.06), ("fabric", 3.0), ("press", 2e4)] {
        let map = MAPS.iter().find(|map| map.name == name).expect("is on the list");
        assert!(map.values.contains(&value), "{name} {value} is a cell of the map");
        let cell = map.cell(value, Column::Quality(Quality::Standard)).expect("the scene can be made");
        println!("{name} {value}: {} in {:.1} s {}", cell.outcome.name(), cell.wall, cell.why);
        assert_eq!(cell.outcome, Outcome::Sound, "{name} {value}: {}", cell.why);
    }
}
