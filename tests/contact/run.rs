//! Scenes of cloth in contact, built from parts of the library, and how they are judged: crossings are counted exactly
//! after every accepted step.

use crate::shapes::Shape;
use crease_geometry::math::{Rng, Vec2, Vec3};
use crease_geometry::mesh::intersections::self_intersections;
use crease_geometry::mesh::{PointIndex, Topology};
use crease_model::garment::RestState;
use crease_solver::contact::{BodyContactSettings, BodyPlanes, Contact, ContactSettings};
use crease_solver::energy::{
    Bending, EdgeContact, EdgeContacts, Energy, Junctions, Membrane, PlaneContact, PlaneContacts,
};
use crease_solver::sim::Loads;
use crease_solver::sim::{
    Cloth, Method, NewtonOptions, State, StepOptions, StepRelaxation, StepReport, Stepper,
};
use std::sync::Arc;
use std::time::Instant;

/// Cloth before it is made: points in space, triangles, and each triangle laid flat.
#[derive(Debug, Clone, Default)]
pub struct Pattern {
    pub x: Vec<Vec3>,
    pub triangles: Vec<[PointIndex; 3]>,
    pub material: Vec<[Vec2; 3]>,
}

impl Pattern {
    /// Adds a lattice of `across` x `along` quads (diagonals in a union-jack pattern); `position` returns the position in space [m]
    /// of a fraction of it, `size` is its size laid flat [m]. `closed`: its left and right border are one.
    pub fn add(
        &mut self,
        quads: [usize; 2],
        size: [f64; 2],
        closed: bool,
        position: impl Fn(f64, f64) -> Vec3,
    ) -> &mut Self {
        let [m, n] = quads;
        let base = self.x.len() as u32;
        let columns = if closed { m } else { m + 1 };
        for j in 0..=n {
            for i in 0..columns {
                self.x.push(position(i as f64 / m as f64, j as f64 / n as f64));
            }
        }
        let at = |i: usize, j: usize| PointIndex(base + (j * columns + i % columns) as u32);
        let flat =
            |i: usize, j: usize| Vec2::new(i as f64 * size[0] / m as f64, j as f64 * size[1] / n as f64);
        for j in 0..n {
            for i in 0..m {
                let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let cut = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                for t in cut {
                    self.triangles.push(t.map(|(i, j)| at(i, j)));
                    self.material.push(t.map(|(i, j)| flat(i, j)));
                }
            }
        }
        self
    }

    /// A level square of side `size` [m] around `centre`, of about `points` points.
    pub fn square(points: usize, size: f64, centre: Vec3) -> Self {
        let n = ((points as f64).sqrt().round() as usize).max(3) - 1;
        let mut pattern = Self::default();
        pattern.add([n, n], [size, size], false, |u, v| {
            centre + Vec3::new((u - 0.5) * size, 0.0, (0.5 - v) * size)
        });
        pattern
    }

    /// Moves every point by up to `most` [m] along every axis.
    pub fn jitter(&mut self, most: f64, seed: u64) {
        let mut rng = Rng::from_seed(seed);
        self.x.iter_mut().for_each(|x| *x += rng.in_cube() * most);
    }
}

/// Properties of the cloth.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// [kg/m²].
    pub density: f64,
    /// [N/m].
    pub stretch: f64,
    /// [N·m].
    pub bend: f64,
    /// [m].
    pub thickness: f64,
    pub friction: f64,
    pub static_ratio: f64,
}

/// A light cotton, with the stretch stiffness that a bake lowers it to.
pub const COTTON: Kind =
    Kind { density: 0.2, stretch: 400.0, bend: 5e-6, thickness: 1e-3, friction: 0.3, static_ratio: 1.0 };

/// The body's points at the end of a step [m], and the contacts of the cloth with it.
#[derive(Clone)]
struct BodyStep {
    points: Arc<[Vec3]>,
    planes: Arc<[PlaneContact]>,
    edges: Arc<[EdgeContact]>,
}

impl Default for BodyStep {
    fn default() -> Self {
        Self { points: Arc::new([]), planes: Arc::new([]), edges: Arc::new([]) }
    }
}

/// A running scene.
pub struct Run {
    pub stepper: Stepper,
    pub state: State,
    pub memory: RestState,
    pub triangles: Vec<[PointIndex; 3]>,
    topology: Topology,
    /// The body under the cloth, and its contacts in the last step.
    body: Option<BodyPlanes>,
    body_step: BodyStep,
    /// Crossings of the cloth with itself after the worst accepted step.
    pub worst: usize,
    pub steps: usize,
    pub solves: usize,
    pub unconverged: usize,
    /// Fastest point after any step [m/s], when [s] and where [m].
    pub fastest: f64,
    pub fastest_at: (f64, Vec3),
    begun: Instant,
}

impl Run {
    /// Cloth of `kind` at rest. `layers`: how many it must be able to carry.
    pub fn new(pattern: &Pattern, kind: Kind, layers: f64) -> Self {
        let topology = Topology::new(pattern.x.len(), &pattern.triangles);
        let corners: Vec<[u32; 3]> = pattern.triangles.iter().map(|t| t.map(|p| p.0)).collect();
        let k = kind.stretch;
        let membrane = Membrane::from_parts(&corners, &pattern.material, [k, k, 0.3 * k], 0.002);
        let mut area = vec![0.0; pattern.x.len()];
        for (t, a) in corners.iter().zip(membrane.area()) {
            t.iter().for_each(|&p| area[p as usize] += a / 3.0);
        }
        let mass = area.iter().map(|a| a * kind.density).collect();
        let bending = Bending::from_parts(&topology, &pattern.material, [kind.bend; 2], 0.02);
        let angle = bending.angles(&pattern.x, &[]);
        let mean_area = area.iter().sum::<f64>() / area.len() as f64;
        let load = layers * kind.density * crease_solver::sim::GRAVITY;
        let stiffness = (load / (0.3 * kind.thickness)).max(k / mean_area);
        let mut settings = ContactSettings::uniform(kind.thickness, stiffness, kind.friction);
        settings.static_ratio = kind.static_ratio;
        let contact = Contact::new(settings, &pattern.x, &pattern.triangles, &topology, area.clone());
        let cloth = Cloth { mass, area, membrane, bending, junctions: Junctions::default() };
        // As in a bake, but for the steps, which may be shorter.
        let energy = 3e-6 * cloth.mass.iter().sum::<f64>() * crease_solver::sim::GRAVITY;
        let options = StepOptions {
            method: Method::BackwardEuler,
            newton: NewtonOptions {
                displacement_tol: 3e-5,
                decrement_tol: energy,
                rel_decrement_tol: 0.0,
                max_iterations: 10,
            },
            local_error_tol: 1e-3,
            min_dt: 1.0 / 240.0,
            max_dt: 1.0 / 30.0,
            relaxation: StepRelaxation::OFF,
        };
        Self {
            memory: RestState::flat(topology.hinges.len(), pattern.triangles.len()),
            stepper: Stepper::new(cloth, contact, options),
            state: State::at_rest(pattern.x.clone(), angle),
            triangles: pattern.triangles.clone(),
            topology,
            body: None,
            body_step: BodyStep::default(),
            worst: 0,
            steps: 0,
            solves: 0,
            unconverged: 0,
            fastest: 0.0,
            fastest_at: (0.0, Vec3::zeros()),
            begun: Instant::now(),
        }
    }

    /// Puts `shape` under the cloth. It takes part in steps whose loads say where its points are.
    pub fn put_on(&mut self, shape: &Shape) {
        let settings = self.stepper.contact.settings();
        let settings = BodyContactSettings {
            point_dhat: vec![settings.dhat; self.stepper.cloth.area.len()],
            edge_dhat: settings.dhat,
            stiffness: settings.stiffness,
            areas: self.stepper.cloth.area.clone(),
            friction: settings.friction_body,
            slip_velocity_tol: settings.slip_velocity_tol,
        };
        self.body = Some(BodyPlanes::new(&shape.points, &shape.triangles, settings));
    }

    /// Force of the body on the cloth in the last step [N], with friction.
    pub fn body_force(&self) -> Vec3 {
        let mut gradient = vec![Vec3::zeros(); self.state.x.len()];
        PlaneContacts(&self.body_step.planes).add_gradient(&self.state.x, &mut gradient);
        EdgeContacts(&self.body_step.edges).add_gradient(&self.state.x, &mut gradient);
        -gradient.iter().sum::<Vec3>()
    }

    /// Force of ground and ceiling on the cloth [N], without friction: those between layers add up to nothing.
    pub fn plane_force(&self) -> Vec3 {
        let mut gradient = vec![Vec3::zeros(); self.state.x.len()];
        self.stepper.contact.add_gradient(&self.state.x, &mut gradient);
        -gradient.iter().sum::<Vec3>()
    }

    /// From now on steps are solved as far as rounding allows.
    pub fn precisely(&mut self) {
        self.stepper.options.newton = NewtonOptions {
            displacement_tol: 1e-8,
            decrement_tol: 0.0,
            rel_decrement_tol: 0.0,
            max_iterations: 60,
        };
    }

    /// One step of at most `wished` seconds.
    pub fn step(&mut self, mut drive_at: &mut dyn FnMut(f64, &State) -> Loads, wished: f64) -> StepReport {
        let report = match self.body.take() {
            Some(body) => self.step_on_body(body, drive_at, wished),
            None => self.stepper.advance(&mut self.state, &self.memory, &mut drive_at, wished),
        };
        assert!(self.state.x.iter().all(|x| x.sum().is_finite()), "not finite at {} s", self.state.time);
        self.steps += 1;
        self.solves += report.newton.global_iterations;
        self.unconverged += usize::from(!report.converged);
        for (v, x) in self.state.v.iter().zip(&self.state.x) {
            if v.norm() > self.fastest {
                (self.fastest, self.fastest_at) = (v.norm(), (self.state.time, *x));
            }
        }
        self.worst = self.worst.max(self.crossings());
        report
    }

    /// One step with the body under the cloth, as a bake makes it.
    fn step_on_body(
        &mut self,
        mut body: BodyPlanes,
        drive_at: &mut dyn FnMut(f64, &State) -> Loads,
        wished: f64,
    ) -> StepReport {
        let start = self.state.time;
        let mut met: Option<BodyStep> = None;
        let mut begun = false;
        let (triangles, topology) = (&self.triangles, &self.topology);
        let mut drive_on_body = |time: f64, state: &State| {
            let mut drive = drive_at(time, state);
            if let Some(posed) = drive.body.take() {
                let points = posed.points;
                if !begun {
                    body.begin_step(&state.x, triangles, topology, &drive.fixed);
                    begun = true;
                }
                let normals = body.normals(&points);
                let h = time - start;
                drive.plane_contacts =
                    body.plane_contacts(&state.x, &points, &normals, h, drive.friction).into();
                drive.edge_contacts = body.edge_contacts(&points, &normals).into();
                let carried = body.carried_displacement(&state.x, &points);
                drive.body_displacement = carried.into_iter().map(Option::unwrap_or_default).collect();
                met = Some(BodyStep {
                    points,
                    planes: Arc::clone(&drive.plane_contacts),
                    edges: Arc::clone(&drive.edge_contacts),
                });
            }
            drive
        };
        let report = self.stepper.advance(&mut self.state, &self.memory, &mut drive_on_body, wished);
        if let Some(met) = met {
            body.end_step(&self.state.x, &met.points, &met.planes, &met.edges);
            self.body_step = met;
        }
        self.body = Some(body);
        report
    }

    /// Goes on for `seconds`.
    pub fn go(&mut self, seconds: f64, drive_at: &mut dyn FnMut(f64, &State) -> Loads) {
        self.watch(seconds, drive_at, &mut |_, _| true);
    }

    /// Goes on for `seconds` at most, until `watch` says no.
    pub fn watch(
        &mut self,
        seconds: f64,
        drive_at: &mut dyn FnMut(f64, &State) -> Loads,
        watch: &mut dyn FnMut(&mut Self, &StepReport) -> bool,
    ) {
        let end = self.state.time + seconds;
        let mut wished = 1.0 / 240.0;
        while self.state.time < end - 1e-9 {
            let left = end - self.state.time;
            let report =
                self.step(drive_at, if wished >= left { left } else { wished.min(0.5 * left.max(wished)) });
            wished = report.next_dt;
            self.tell(report.dt);
            if !watch(self, &report) {
                break;
            }
        }
    }

    /// Prints the progress of a long run to stderr, ten times a simulated second.
    fn tell(&self, step: f64) {
        const LONG: usize = 5_000;
        let tenths = |time: f64| (10.0 * time + 1e-6).floor();
        if self.state.x.len() > LONG && tenths(self.state.time) > tenths(self.state.time - step) {
            eprintln!("{:.2} s, {} steps, {} solves", self.state.time, self.steps, self.solves);
        }
    }

    /// Pairs of triangles of the cloth that cross now.
    pub fn crossings(&self) -> usize {
        self_intersections(&self.state.x, &self.triangles).len()
    }

    /// [J].
    pub fn kinetic_energy(&self) -> f64 {
        self.stepper.cloth.kinetic_energy(&self.state.v)
    }

    /// [N].
    pub fn weight(&self) -> f64 {
        self.stepper.cloth.mass.iter().sum::<f64>() * crease_solver::sim::GRAVITY
    }

    pub fn line(&self, name: &str) -> String {
        format!(
            "{name}: {} points, {:.2} s in {} steps ({} not converged), {} solves, {:.1} s wall; fastest {:.2} m/s at \
             {:.2} s ({:.3}, {:.3}, {:.3}); crossings {}",
            self.state.x.len(),
            self.state.time,
            self.steps,
            self.unconverged,
            self.solves,
            self.begun.elapsed().as_secs_f64(),
            self.fastest,
            self.fastest_at.0,
            self.fastest_at.1.x,
            self.fastest_at.1.y,
            self.fastest_at.1.z,
            self.worst
        )
    }
}
