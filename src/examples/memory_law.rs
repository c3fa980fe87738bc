//! The memory law in a simulator of your own: angles of hinges in, rest angles and stiffness out.
//!
//! `cargo run --release --example memory_law`

use crease::law::{Memory, MemoryModel, Strains};
use crease::{Fabric, RestState};

fn main() -> crease::Result<()> {
    // 2 hinges, 20 mm wide: the angles of the mesh as modelled [rad], 0 for flat.
    let initial = vec![0.0, 0.1];
    let model = MemoryModel::for_hinges(&Fabric::preset("kow-tshirt")?, &[0.02, 0.02]);
    let mut memory = Memory::new(RestState::new(initial.clone(), 0));
    let (dt, mut before) = (0.1, initial);
    for k in 1..=110 {
        // Your simulator moves the cloth: here the first hinge folds to 2.8 rad within 1 s and is held.
        let after = vec![2.8 * f64::min(0.1 * f64::from(k), 1.0), 0.1];
        memory.commit(&model, &Strains::of_angles(&before), &Strains::of_angles(&after), dt);
        // Your bending energy takes these until the next step.
        let rest = &memory.effective_rest;
        if k % 10 == 0 {
            println!(
                "{:4.1} s: rest angle {:.2} rad, stiffness x {:.2}",
                0.1 * f64::from(k),
                rest.rest_angle[0],
                rest.stiffness_ratio[0]
            );
        }
        before = after;
    }
    Ok(())
}
