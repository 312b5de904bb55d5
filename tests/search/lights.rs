//! The lights of random scenes.

use super::{Generator, spectra};
use serde_json::{Value, json};

impl Generator {
    /// Adds the lights. `closed` says that light from infinity cannot reach the objects.
    pub(super) fn light_everything(&mut self, closed: bool) {
        let count = if self.rng.chance(0.12) { 9 + self.rng.below(22) } else { 1 + self.rng.below(4) };
        if !closed && self.rng.chance(0.6) {
            self.distant();
        } else {
            self.local(count > 8);
        }
        for _ in 1..count {
            match self.rng.below(12) {
                0 if !closed => self.distant(),
                1 if count < 9 => self.in_glass(),
                2 if count < 9 => self.glow(),
                _ => self.local(count > 8),
            }
        }
    }

    /// Returns a power in W that suits the size of the scene.
    fn power(&mut self) -> f64 {
        self.rng.log_between(20.0, 200.0) * self.scale_m * self.scale_m
    }

    /// Returns a place above the objects.
    fn above(&mut self) -> [f64; 3] {
        [self.rng.between(-1.5, 1.5), self.rng.between(1.3, 2.6), self.rng.between(-1.5, 1.5)]
    }

    fn distant(&mut self) {
        let spectrum = spectra::light(&mut self.rng);
        let irradiance = self.rng.log_between(3.0, 30.0);
        if self.rng.chance(0.4) {
            let light = if self.rng.chance(0.5) {
                json!({ "spectrum": spectrum, "irradiance": irradiance })
            } else {
                json!({ "spectrum": spectrum, "illuminance": 200.0 * irradiance })
            };
            self.lights.push(json!({ "environment": light }));
            return;
        }
        let d = self.rng.direction();
        let toward = [d[0], -d[1].abs() - 0.3, d[2]];
        let diameter = match (self.smooth, self.rng.below(3)) {
            (false, 0) => 0.0,
            (false, 1) => 0.53,
            _ => self.rng.between(15.0, 60.0),
        };
        self.lights.push(json!({ "directional": {
            "toward": toward, "angular_diameter": diameter, "spectrum": spectrum, "irradiance": irradiance
        } }));
    }

    fn local(&mut self, many: bool) {
        if self.smooth || self.rng.chance(0.4) {
            self.area(many);
        } else {
            self.delta();
        }
    }

    /// Adds a light without area.
    fn delta(&mut self) {
        let spectrum = spectra::light(&mut self.rng);
        let (power, place) = (self.power(), self.above());
        let motion = self.shift();
        let target = [self.rng.between(-0.5, 0.5), 0.2, self.rng.between(-0.5, 0.5)];
        let light = match self.rng.below(5) {
            0 | 1 => {
                let (key, value) = self.quantity(power);
                let mut light = json!({ "at": self.at(place), "spectrum": spectrum, "motion": motion });
                light[key] = json!(value);
                json!({ "point": light })
            }
            2 | 3 => {
                let (key, value) = self.quantity(power);
                let half_angle = self.rng.between(15.0, 60.0);
                let penumbra = self.rng.between(0.0, half_angle);
                let mut light = json!({ "at": self.at(place), "to": self.at(target), "half_angle": half_angle, "penumbra": penumbra, "spectrum": spectrum, "motion": motion });
                light[key] = json!(value);
                json!({ "spot": light })
            }
            _ => {
                let radius = self.rng.between(0.1, 0.6) * self.scale;
                let divergence = if self.rng.chance(0.5) { 0.0 } else { self.rng.between(0.5, 20.0) };
                json!({ "beam": { "from": self.at(place), "to": self.at(target), "radius": radius, "divergence": divergence, "spectrum": spectrum, "power": 0.3 * power, "motion": motion } })
            }
        };
        self.lights.push(light);
    }

    fn quantity(&mut self, power: f64) -> (&'static str, f64) {
        match self.rng.below(4) {
            0 => ("power", power),
            1 => ("luminous_flux", 200.0 * power),
            2 => ("intensity", power / 12.0),
            _ => ("luminous_intensity", 200.0 * power / 12.0),
        }
    }

    /// Returns the emission of a surface of about this area.
    fn emission(&mut self, power: f64, area: f64) -> Value {
        let mut emission = json!({ "spectrum": spectra::light(&mut self.rng) });
        let radiance = power / (std::f64::consts::PI * area * self.scale_m * self.scale_m);
        match self.rng.below(4) {
            0 => emission["power"] = json!(power),
            1 => emission["luminous_flux"] = json!(200.0 * power),
            2 => emission["radiance"] = json!(radiance),
            _ => emission["luminance"] = json!(200.0 * radiance),
        }
        emission
    }

    fn lamp_material(&mut self) -> String {
        let material = match self.rng.below(4) {
            0 => json!({ "diffuse": { "reflectance": 0.4 } }),
            1 => json!({ "glossy": { "reflectance": 0.3, "ior": 1.5, "roughness": 0.3 } }),
            _ => json!("absorber"),
        };
        self.palette.add(material)
    }

    fn area(&mut self, many: bool) {
        let size = if self.smooth { self.rng.between(0.3, 0.8) } else { self.rng.log_between(0.2, 0.8) };
        let (power, place) = (self.power(), self.above());
        let size = if many { 0.5 * size } else { size };
        let shape = match self.rng.below(6) {
            0 | 1 => json!({ "rectangle": { "width": size * self.scale, "height": size * self.scale } }),
            2 => json!({ "disk": { "radius": 0.5 * size * self.scale } }),
            3 => json!({ "sphere": { "radius": 0.4 * size * self.scale } }),
            _ => self.closed_shape(size),
        };
        let flat = shape.get("rectangle").is_some() || shape.get("disk").is_some();
        let emission = self.emission(power, size * size);
        let rotation = if flat && self.rng.chance(0.6) { Some(([1.0, 0.0, 0.0], 180.0)) } else { self.rotation() };
        let (transform, motion) = self.placement_and_motion(rotation, place, 0.4);
        let material = self.lamp_material();
        self.objects.push(
            json!({ "shape": shape, "material": material, "transform": transform, "motion": motion, "emission": emission }),
        );
    }

    /// Adds a light inside a ball of glass, or half inside it.
    fn in_glass(&mut self) {
        let (power, place) = (self.power(), self.above());
        let radius = self.rng.between(0.2, 0.4);
        let glass = self.palette.glass(&mut self.rng, 2.0 * radius, 0);
        let transform = self.placement(None, place);
        self.push(json!({ "sphere": { "radius": radius * self.scale } }), &glass, transform);
        let lamp = radius * self.rng.between(0.3, 0.6);
        let offset = if self.rng.chance(0.5) { 0.0 } else { radius };
        let shift = self.rng.direction().map(|x| x * offset);
        let emission = self.emission(power, 12.0 * lamp * lamp);
        let material = self.lamp_material();
        let transform = self.placement(None, [0, 1, 2].map(|i| place[i] + shift[i]));
        self.objects.push(json!({ "shape": { "sphere": { "radius": lamp * self.scale } }, "material": material, "transform": transform, "emission": emission }));
    }

    /// Adds a glowing body of gas above the objects.
    fn glow(&mut self) {
        let (power, place, size) = (self.power(), self.above(), self.rng.between(0.3, 0.6));
        let radiance = power / (std::f64::consts::PI * size * size * self.scale_m * self.scale_m);
        let medium = self.palette.glowing(&mut self.rng, size, power, radiance);
        let material = self.palette.boundary(&medium);
        let shape = self.closed_shape(size);
        // Abbe refuses glowing media that move.
        let rotation = self.rotation();
        let transform = self.placement(rotation, place);
        self.push(shape, &material, transform);
    }
}
