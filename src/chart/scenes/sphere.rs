//! A square of cloth that falls on a ball, which then turns: contact with friction, and folds that form.
//!
//! 0.3 m, 15 x 15 quads, on a ball of 0.1 m; the ball turns by 90 degrees from 0.5 to 1 s. Where the folds go is decided by
//! little: three seeds, and errors as their median.

use crate::chart::scenes::{Actors, Kind, Scene, Sheet, smoothstep, spaced};
use crate::contact::Body;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::sim::Drive;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const SIDE: f64 = 0.3;
const QUADS: usize = 15;
const BALL: f64 = 0.1;
/// Rings of the ball.
const RINGS: usize = 12;
const THICKNESS: f64 = 2e-3;

/// The scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverSphere {
    /// Which bumps of 0.1 mm the cloth starts with.
    pub seed: u32,
}

impl Scene for OverSphere {
    fn name(&self) -> &'static str {
        "sphere-twist"
    }

    fn until(&self) -> f64 {
        1.2
    }

    fn size(&self) -> f64 {
        SIDE
    }

    fn breaks(&self) -> Vec<f64> {
        vec![0.5, 1.0]
    }

    fn begin(&self) -> Result<Actors> {
        let sheet = Sheet::strip(&spaced(-0.5 * SIDE, 0.5 * SIDE, QUADS), SIDE, QUADS);
        let bump = |p: &crate::math::Vec2| {
            let phase = f64::from(self.seed);
            1e-4 * ((41.0 + phase) * p.x + phase).sin() * ((37.0 - phase) * p.y + 2.0 * phase).cos()
        };
        let place = |p: &crate::math::Vec2| Vec3::new(p.x, BALL + 2.0 * THICKNESS + bump(p), -p.y);
        let garment = sheet.garment(sheet.flat.iter().map(place).collect());
        let kind = Kind { density: 0.2, stretch: 120.0, bend: 1e-5, damping: [0.002, 0.02] };
        let cloth = kind.cloth(&sheet, &garment);
        let mut contact = kind.contact(&garment, &cloth, THICKNESS, 0.3, 4.0);
        let (points, triangles) = ball();
        contact.set_body(Some(Body::new(points, triangles)?));
        Ok(Actors::new(garment, cloth, contact))
    }

    fn drive(&self, t: f64, _x: &[Vec3]) -> Drive {
        let (sin, cos) = (FRAC_PI_2 * smoothstep(t, 0.5, 1.0)).sin_cos();
        let turned = |p: &Vec3| Vec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x);
        let points: Vec<Vec3> = ball().0.iter().map(turned).collect();
        Drive { body: Some(points.into()), ..Drive::at_rest(None) }
    }
}

/// Points [m] and triangles of the ball.
fn ball() -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
    let columns = 2 * RINGS;
    let mut points = vec![Vec3::y() * BALL];
    for i in 1..RINGS {
        let (sin, cos) = (PI * i as f64 / RINGS as f64).sin_cos();
        points.extend((0..columns).map(|j| {
            let (s, c) = (TAU * j as f64 / columns as f64).sin_cos();
            Vec3::new(sin * c, cos, sin * s) * BALL
        }));
    }
    points.push(-Vec3::y() * BALL);
    let last = points.len() - 1;
    let at = |i: usize, j: usize| match i {
        0 => PointIndex(0),
        RINGS => PointIndex(last as u32),
        _ => PointIndex((1 + (i - 1) * columns + j % columns) as u32),
    };
    let mut triangles = Vec::new();
    for i in 0..RINGS {
        for j in 0..columns {
            if i > 0 {
                triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            }
            if i + 1 < RINGS {
                triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
    }
    (points, triangles)
}
