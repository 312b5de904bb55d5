//! Turns a polariser in front of light that water reflects at Brewster's angle and at 70°.
//!
//!     cargo run -p abbe-polarisation --example glare_on_water

use abbe_polarisation::surface::SurfaceMatrices;
use abbe_polarisation::{Mueller, Rotation, Stokes, filter};

fn main() {
    println!("polariser   at 53.1°   at 70.0°   (fraction of the light, 0° = horizontal)");
    for degrees in (0..=90).step_by(15).map(f64::from) {
        let polariser = Mueller::from(filter::IDEAL_POLARISER).turned(Rotation::degrees(degrees));
        let seen = [53.1_f64, 70.0].map(|incidence| {
            let water = SurfaceMatrices::dielectric(incidence.to_radians().cos(), 1.0, 1.333);
            (polariser * (water.reflected * Stokes::unpolarised(1.0))).power()
        });
        println!("{degrees:>8}° {:>10.5} {:>10.5}", seen[0], seen[1]);
    }
}
