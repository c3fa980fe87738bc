//! Frames of a garment that is refined: what is played back are the triangles of its file.

use crate::bakes::folds;
use crease::internal::bake::{Bake, BakeOptions, Observer};
use crease::internal::files::GarmentFile;
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::error::Result;
use crease_model::fabric::Fabric;

/// Counts crossings of the triangles of a file in the frames of a garment refined from it.
struct CountInFile<'a> {
    triangles: &'a [[PointIndex; 3]],
    frames: usize,
    worst: usize,
}

impl Observer for CountInFile<'_> {
    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        self.frames += 1;
        self.worst = self.worst.max(self_intersections(x, self.triangles).len());
        Ok(())
    }
}

/// Requirement: what is played back of a garment refined with `--resolution` are the triangles of its file, and they do not cross, though each
/// spans several layers of the stack that it lies in.
#[test]
fn frames_of_a_refined_garment_do_not_cross_on_the_triangles_of_its_file() {
    let file = GarmentFile::sheet([0.3, 0.3], [7, 7]).expect("a sheet").garment;
    let refined = file.refine(0.012, &[]).garment;
    assert_eq!(refined.exported_triangles(), &file.triangles[..]);
    let fabric = Fabric::preset("cotton-jersey").expect("is ready");
    let script = format!(r#"{{"format": "crease-wear/1", "actions": [{}]}}"#, folds(2));
    let script = WearScript::parse("folds.json", &script).expect("is valid");
    for own_triangles in [false, true] {
        let options = BakeOptions { frames_per_second: 4.0, own_triangles, ..BakeOptions::default() };
        let mut count = CountInFile { triangles: &file.triangles, frames: 0, worst: 0 };
        let baked = Bake::new(&refined, &fabric, &script).options(options).run_with(&mut count);
        let baked = baked.expect("runs");
        println!("{} frames, {} crossings in the worst", count.frames, count.worst);
        assert!(count.frames > 10 && count.worst == 0, "{} in {} frames", count.worst, count.frames);
        let worn: Vec<Vec3> = file.points.iter().zip(&baked.worn.displacement).map(|(x, d)| x + d).collect();
        assert!(self_intersections(&worn, &file.triangles).is_empty());
    }
}
