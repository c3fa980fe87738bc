//! Garments of files: wedges at seams, inspection, refinement.

mod wedges {
    use crease_io::{ReadOptions, read_asset};
    use crease_model::garment::*;

    /// Two triangles joined at an edge whose texture is split there.
    #[test]
    fn at_a_seam_each_triangle_has_its_own_vertices() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt .4 0\nvt 0 .4\nvt .6 .6\nvt .6 1\nvt 1 .6\n\
                    f 1/1 2/2 3/3\nf 4/4 3/5 2/6\n";
        let (asset, _) =
            read_asset("two.obj", text.as_bytes(), &ReadOptions::default(), &mut |_| Ok(Vec::new())).unwrap();
        let (garment, _) = Garment::from_asset(&asset).unwrap();
        assert_eq!(garment.points.len(), 4);
        let corners = corner_vertices(&asset, &garment).unwrap();
        let uvs = corner_uvs(&asset, &corners).unwrap();
        for (t, (vertices, uv)) in garment.triangles.iter().zip(corners.iter().zip(&uvs)) {
            for k in 0..3 {
                assert_eq!(garment.source_point[vertices[k] as usize], t[k]);
            }
            let split = uv.iter().all(|uv| uv.x < 0.5) || uv.iter().all(|uv| uv.x > 0.5);
            assert!(split, "{uv:?} mixes both panels");
        }
    }
}

mod inspect {
    use crease_io::{ReadOptions, read_asset};
    use crease_model::garment::*;

    /// A square of 10 cm with a stray triangle of two corners, in centimetres.
    const TEXT: &str = "o Hanky\nv 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
        usemtl cotton\nf 1/1 2/2 3/3 4/4\nf 1/1 2/2\n";

    fn report() -> Inspection {
        let options = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
        let (asset, mut diagnostics) =
            read_asset("hanky.obj", TEXT.as_bytes(), &options, &mut |_| Ok(Vec::new())).unwrap();
        let (garment, more) = Garment::from_asset(&asset).unwrap();
        diagnostics.extend(more);
        inspect(&asset, &garment, &diagnostics)
    }

    #[test]
    fn the_text_is_for_people() {
        let expected = "\
hanky.obj (OBJ, y up, 1 unit = 0.01 m)
  box        0.100 x 0.100 x 0.000 m (10.0000 x 10.0000 x 0.0000 file units)
  piece#0    \"Hanky\": 4 vertices, 2 triangles, material \"cotton\", UV
  mesh       4 vertices, 4 points (0 welded), 2 triangles (0 dropped), 1 hinges
  edges      mean 108.28 mm, shortest 100.000 mm; 0 non-manifold, 0 misoriented
  parts      1 (2 triangles), 0.010 m2 of cloth
  openings   1 (0.400 m)
  warp       from texture coordinates; 1 worn pieces have texture coordinates
  crossings  not counted
  note       warp along u of the texture coordinates (1 islands)
  repaired   line 12: 1 faces of fewer than 3 corners dropped
";
        assert_eq!(report().to_text(), expected);
    }

    #[test]
    fn the_json_says_its_units() {
        let json = serde_json::to_value(report()).unwrap();
        assert!((json["mean_edge_mm"].as_f64().unwrap() - 108.284).abs() < 1e-3);
        assert!((json["parts"][0]["area_m2"].as_f64().unwrap() - 0.01).abs() < 1e-12);
        assert_eq!(json["repaired"][0]["severity"], "repaired");
        assert_eq!(json["crossings_at_start"], serde_json::Value::Null);
    }
}

mod refine {
    use crease_io::{ReadOptions, read_asset};
    use crease_model::garment::*;

    fn garment() -> Garment {
        let text = "v 0 0 0\nv 0.2 0 0\nv 0.2 0.1 0\nv 0 0.1 0\nv 0.3 0.05 0.1\nf 1 2 3\nf 1 3 4\nf 2 5 3\n";
        let asset =
            read_asset("a.obj", text.as_bytes(), &ReadOptions::default(), &mut |_: &str| Ok(Vec::new()));
        Garment::from_asset(&asset.expect("is a mesh").0).expect("is a garment").0
    }

    use crease_geometry::math::Vec2;

    fn area(flat: &[Vec2; 3]) -> f64 {
        0.5 * (flat[1] - flat[0]).perp(&(flat[2] - flat[0]))
    }

    #[test]
    fn finer_with_the_same_points_area_and_border() {
        let coarse = garment();
        let RefinedMesh { garment: fine, parent } = coarse.refine(0.01, &[]);
        assert_eq!(fine.points[..5], coarse.points[..]);
        assert_eq!(fine.source_point, coarse.source_point);
        let mean = fine.mean_edge();
        assert!((0.006..0.0115).contains(&mean), "{mean}");
        assert!(
            fine.topology
                .edges
                .iter()
                .all(|e| (fine.points[e[0].at()] - fine.points[e[1].at()]).norm() < 0.0134)
        );
        let mut sums = [0.0; 3];
        for (flat, parent) in fine.material.iter().zip(&parent) {
            assert!(area(flat) > 1e-6);
            sums[*parent as usize] += area(flat);
        }
        for (sum, flat) in sums.iter().zip(&coarse.material) {
            assert!((sum - area(flat)).abs() < 1e-15);
        }
        // No T-junctions: as many border loops as before, and no edge of three.
        assert_eq!(fine.topology.boundary_loops(&fine.triangles).len(), 1);
        assert!(fine.topology.edge_valence.iter().all(|v| *v <= 2) && fine.topology.misoriented.is_empty());
        // Flat corners are as far apart as the points: the source shape is without strain.
        for (t, flat) in fine.triangles.iter().zip(&fine.material) {
            for k in 0..3 {
                let [a, b] = [t[k], t[(k + 1) % 3]].map(|p| fine.points[p.at()]);
                assert!(((a - b).norm() - (flat[k] - flat[(k + 1) % 3]).norm()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn only_where_wanted_and_never_coarser() {
        let coarse = garment();
        assert_eq!(coarse.refine(1.0, &[]).garment.triangles, coarse.triangles);
        let mut wanted = [false; 5];
        wanted[4] = true;
        let fine = coarse.refine(0.01, &wanted);
        let of = |parent: u32| fine.parent.iter().filter(|p| **p == parent).count();
        assert!(of(2) > 50 && of(1) < 10, "{} {}", of(2), of(1));
    }
}
