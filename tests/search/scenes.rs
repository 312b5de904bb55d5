//! The generator of random scenes.
//!
//! A scene fills a region around the origin with a radius of about 1. The generator then scales and
//! moves it. The camera looks at the region from a distance of about 2.6.

use crate::materials::{Palette, Use};
use crate::random::Pcg;
use crate::refined;
use crate::spectra;
use serde_json::{Value, json};

/// The half side and the height of a closed room.
const ROOM: [f64; 2] = [3.2, 3.0];

struct Generator {
    rng: Pcg,
    palette: Palette,
    objects: Vec<Value>,
    lights: Vec<Value>,
    /// The scene's length unit of the generator, in units of the scene file.
    scale: f64,
    /// The same length in m.
    scale_m: f64,
    /// The scene's centre in units of the scene file.
    origin: [f64; 3],
    moving: bool,
    smooth: bool,
    /// The size of everything.
    world: f64,
    /// True if there is a wall behind the objects, at negative z.
    wall: bool,
}

/// Returns the scene of a seed.
pub(crate) fn scene(seed: u64) -> Value {
    let mut rng = Pcg::new(seed);
    let scale_m = rng.pick(&[1e-3, 1e-2, 0.1, 1.0, 1.0, 1.0, 10.0, 1e3, 1e5]);
    let (unit, unit_m) = rng.pick(&[("m", 1.0), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6)]);
    let scale = scale_m / unit_m;
    let origin = if rng.chance(0.5) {
        [0.0; 3]
    } else {
        let distance = scale * rng.log_between(1.0, 1e4);
        rng.direction().map(|x| x * distance)
    };
    let smooth = rng.chance(0.55);
    let moving = rng.chance(0.3);
    let palette = Palette::new(scale, smooth);
    let generator = Generator {
        rng,
        palette,
        objects: Vec::new(),
        lights: Vec::new(),
        scale,
        scale_m,
        origin,
        moving,
        smooth,
        world: 2.0 * ROOM[0],
        wall: false,
    };
    generator.scene(unit, seed)
}

impl Generator {
    fn at(&self, p: [f64; 3]) -> Value {
        json!([0, 1, 2].map(|i: usize| self.origin[i] + self.scale * p[i]))
    }

    fn vector(&self, v: [f64; 3]) -> Value {
        json!(v.map(|x| x * self.scale))
    }

    /// Returns a transform that rotates a shape and moves it to a place.
    fn placement(&self, rotation: Option<([f64; 3], f64)>, place: [f64; 3]) -> Value {
        let mut steps = Vec::new();
        if let Some((axis, degrees)) = rotation {
            steps.push(json!({ "rotate": { "axis": axis, "degrees": degrees } }));
        }
        steps.push(json!({ "translate": self.at(place) }));
        json!(steps)
    }

    /// Returns the transform of a shape at a place, and its keyframes or none. The motion is a
    /// small shift, perhaps with a rotation about the shape's own origin.
    fn placement_and_motion(
        &mut self,
        rotation: Option<([f64; 3], f64)>,
        place: [f64; 3],
        probability: f64,
    ) -> (Value, Value) {
        if !self.moving || !self.rng.chance(probability) {
            return (self.placement(rotation, place), json!([]));
        }
        let at_end = self.shifted(place);
        let turn = self.rng.chance(0.5).then(|| (self.rng.direction(), self.rng.between(5.0, 60.0)));
        let start = self.placement(None, place);
        let end = self.placement(turn, at_end);
        let transform =
            rotation.map_or(json!([]), |(axis, degrees)| json!([{ "rotate": { "axis": axis, "degrees": degrees } }]));
        (transform, json!([{ "time": 0, "transform": start }, { "time": 1, "transform": end }]))
    }

    fn shifted(&mut self, place: [f64; 3]) -> [f64; 3] {
        let distance = self.rng.between(0.03, 0.3);
        let shift = self.rng.direction();
        [0, 1, 2].map(|i| place[i] + distance * shift[i])
    }

    /// Returns the keyframes of a small shift, or none.
    fn shift(&mut self) -> Value {
        if !self.moving || self.rng.chance(0.5) {
            return json!([]);
        }
        let by = self.shifted([0.0; 3]);
        json!([{ "time": 0, "transform": [] }, { "time": 1, "transform": [{ "translate": self.vector(by) }] }])
    }

    fn push(&mut self, shape: Value, material: &str, transform: Value) {
        self.objects.push(json!({ "shape": shape, "material": material, "transform": transform }));
    }

    fn scene(mut self, unit: &str, seed: u64) -> Value {
        let closed = self.surroundings();
        self.bodies();
        self.fog(closed);
        self.light_everything(closed);
        // In an open world, too few photons of distant lights are scattered near the camera.
        let foggy = closed && self.rng.chance(0.25);
        let atmosphere = foggy.then(|| self.palette.homogeneous(&mut self.rng, self.world, 0));
        let camera = self.camera();
        let rng = &mut self.rng;
        let height = rng.pick(&[8, 10, 12]);
        let mut render = json!({ "photons": 3000 + rng.below(6000), "seed": seed });
        if rng.chance(0.05) {
            render["max_depth"] = json!(3 + rng.below(6));
        }
        if rng.chance(0.1) {
            render["nearest"] = json!(20 + rng.below(60));
        }
        let mut scene = json!({
            "title": format!("random scene {seed}"), "unit": unit, "camera": camera,
            "film": { "width": 3 * height / 2, "height": height,
                      "observer": rng.pick(&["cie1931", "cie1931", "cie1964", "cie2015_2"]) },
            "media": self.palette.media, "materials": self.palette.materials,
            "objects": self.objects, "lights": self.lights, "render": render
        });
        if let Some(medium) = atmosphere {
            scene["atmosphere"] = json!(medium);
        }
        if seed >= refined::FIRST_SEED {
            refined::refine(&mut scene, &mut self.rng, self.smooth, self.scale);
        }
        if seed >= refined::FIRST_OVERLAP {
            refined::overlap_glowing_bodies(&mut scene, &mut self.rng, self.smooth, self.scale);
        }
        scene
    }

    /// Adds a closed room, a floor, or a floor and a wall. Returns whether the room is closed.
    fn surroundings(&mut self) -> bool {
        let [half, height] = ROOM;
        let wall = |this: &mut Self| this.palette.surface(&mut this.rng, Use::Wall, 1.0);
        let plate =
            |this: &Self, w: f64, h: f64| json!({ "rectangle": { "width": w * this.scale, "height": h * this.scale } });
        match self.rng.below(10) {
            0..3 => {
                let material = wall(self);
                let size = self.vector([2.0 * half, height, 2.0 * half]);
                let place = self.placement(None, [0.0, 0.5 * height, 0.0]);
                self.push(json!({ "box": { "size": size } }), &material, place);
                true
            }
            3..5 => {
                for (axis, degrees, place, side) in [
                    ([1.0, 0.0, 0.0], 0.0, [0.0, 0.0, 0.0], [2.0 * half, 2.0 * half]),
                    ([1.0, 0.0, 0.0], 180.0, [0.0, height, 0.0], [2.0 * half, 2.0 * half]),
                    ([1.0, 0.0, 0.0], 90.0, [0.0, 0.5 * height, -half], [2.0 * half, height]),
                    ([1.0, 0.0, 0.0], -90.0, [0.0, 0.5 * height, half], [2.0 * half, height]),
                    ([0.0, 0.0, 1.0], -90.0, [-half, 0.5 * height, 0.0], [height, 2.0 * half]),
                    ([0.0, 0.0, 1.0], 90.0, [half, 0.5 * height, 0.0], [height, 2.0 * half]),
                ] {
                    let material = wall(self);
                    let shape = plate(self, side[0], side[1]);
                    let place = self.placement(Some((axis, degrees)), place);
                    self.push(shape, &material, place);
                }
                true
            }
            kind => {
                let material = wall(self);
                let size = self.rng.log_between(8.0, 800.0);
                self.world = size;
                let place = self.placement(None, [0.0; 3]);
                let shape = if self.rng.chance(0.5) {
                    plate(self, size, size)
                } else {
                    json!({ "disk": { "radius": 0.5 * size * self.scale } })
                };
                self.push(shape, &material, place);
                if kind >= 8 {
                    self.wall = true;
                    let material = wall(self);
                    let shape = plate(self, 6.0, 6.0);
                    let place = self.placement(Some(([1.0, 0.0, 0.0], 90.0)), [0.0, 2.0, -1.6]);
                    self.push(shape, &material, place);
                }
                false
            }
        }
    }

    /// Returns a random closed shape and its size.
    fn closed_shape(&mut self, size: f64) -> Value {
        let s = size * self.scale;
        let rng = &mut self.rng;
        match rng.below(8) {
            0..3 => json!({ "sphere": { "radius": 0.5 * s } }),
            3 | 4 => {
                json!({ "box": { "size": [s * rng.between(0.3, 1.0), s * rng.between(0.3, 1.0), s * rng.between(0.3, 1.0)] } })
            }
            5 => {
                json!({ "cylinder": { "radius": 0.4 * s * rng.between(0.4, 1.0), "height": s * rng.between(0.3, 1.0) } })
            }
            6 => {
                json!({ "prism": { "side": 0.9 * s, "length": s * rng.between(0.4, 1.0), "apex": rng.between(40.0, 90.0) } })
            }
            _ => {
                json!({ "lens": { "radius1": s * rng.between(0.6, 2.0), "radius2": -s * rng.between(0.6, 2.0), "thickness": 0.45 * s, "diameter": 0.8 * s } })
            }
        }
    }

    fn rotation(&mut self) -> Option<([f64; 3], f64)> {
        self.rng.chance(0.7).then(|| (self.rng.direction(), self.rng.between(0.0, 360.0)))
    }

    fn place(&mut self, size: f64) -> [f64; 3] {
        let low = if self.rng.chance(0.2) { 0.0 } else { 0.55 * size };
        [self.rng.between(-0.9, 0.9), self.rng.between(low, low + 0.7), self.rng.between(-0.9, 0.9)]
    }

    fn bodies(&mut self) {
        for _ in 0..1 + self.rng.below(4) {
            let size = self.rng.between(0.3, 0.9);
            let place = self.place(size);
            match self.rng.below(10) {
                0..2 => self.sheet(size, place),
                2..4 => self.nested(size, place),
                4 => self.overlapping(size, place),
                _ => {
                    let shape = self.closed_shape(size);
                    let material = self.palette.surface(&mut self.rng, Use::Body, size);
                    self.body(shape, &material, place);
                }
            }
        }
    }

    fn body(&mut self, shape: Value, material: &str, place: [f64; 3]) {
        let rotation = self.rotation();
        let (transform, motion) = self.placement_and_motion(rotation, place, 0.5);
        self.objects.push(json!({ "shape": shape, "material": material, "transform": transform, "motion": motion }));
    }

    fn sheet(&mut self, size: f64, place: [f64; 3]) {
        let [width, height] = [size * self.scale, size * self.scale * self.rng.between(0.4, 1.0)];
        let shape = if self.rng.chance(0.7) {
            json!({ "rectangle": { "width": width, "height": height } })
        } else {
            json!({ "disk": { "radius": 0.5 * width } })
        };
        let material = self.palette.surface(&mut self.rng, Use::Sheet, size);
        self.body(shape, &material, place);
    }

    /// Adds a body of glass with shells or another body inside.
    fn nested(&mut self, size: f64, place: [f64; 3]) {
        let shells = if self.rng.chance(0.15) { 9 + self.rng.below(3) } else { 1 + self.rng.below(3) };
        for shell in 0..shells {
            let share = 1.0 - shell as f64 / (shells + 1) as f64;
            let material = self.palette.glass(&mut self.rng, size * share, 0);
            let shape = json!({ "sphere": { "radius": 0.5 * size * share * self.scale } });
            let transform = self.placement(None, place);
            self.push(shape, &material, transform);
        }
        if self.rng.chance(0.6) {
            let core = 0.5 * size / (shells + 1) as f64;
            let shape = self.closed_shape(core);
            let material = self.palette.surface(&mut self.rng, Use::Body, core);
            self.body(shape, &material, place);
        }
    }

    /// Adds two bodies that overlap.
    fn overlapping(&mut self, size: f64, place: [f64; 3]) {
        for _ in 0..2 {
            let priority = self.rng.below(3) as i32;
            let material = self.palette.glass(&mut self.rng, size, priority);
            let shift = self.rng.direction().map(|x| 0.25 * size * x);
            let shape = self.closed_shape(size);
            self.body(shape, &material, [0, 1, 2].map(|i| place[i] + shift[i]));
        }
    }

    /// Adds bodies of fog.
    fn fog(&mut self, closed: bool) {
        if !self.rng.chance(0.4) {
            return;
        }
        for _ in 0..1 + self.rng.below(2) {
            let size = self.rng.between(0.5, if closed { 2.4 } else { 4.0 });
            let place = [self.rng.between(-0.6, 0.6), self.rng.between(0.3, 1.2), self.rng.between(-0.6, 0.6)];
            if self.rng.chance(0.35) {
                let sides = [size, size * self.rng.between(0.5, 1.0), size * self.rng.between(0.5, 1.0)];
                let rotation = self.rotation();
                let (transform, motion) = self.placement_and_motion(rotation, place, 0.5);
                let medium = self.palette.grid(&mut self.rng, sides, (&transform, &motion));
                let material = self.palette.boundary(&medium);
                self.objects.push(json!({ "shape": { "box": { "size": self.vector(sides) } }, "material": material, "transform": transform, "motion": motion }));
            } else {
                let priority = self.rng.below(2) as i32;
                let medium = self.palette.homogeneous(&mut self.rng, size, priority);
                let material = self.palette.boundary(&medium);
                let shape = self.closed_shape(size);
                self.body(shape, &material, place);
            }
        }
    }

    fn camera(&mut self) -> Value {
        // The camera does not stand behind the wall or at it.
        let most = if self.wall { 1.2 } else { std::f64::consts::PI };
        let azimuth = self.rng.between(-most, most);
        let elevation: f64 = self.rng.between(0.2, 0.8);
        let distance = self.rng.between(2.3, 2.7);
        let target = [self.rng.between(-0.2, 0.2), 0.45, self.rng.between(-0.2, 0.2)];
        let from = |azimuth: f64| {
            [
                target[0] + distance * elevation.cos() * azimuth.sin(),
                target[1] + distance * elevation.sin(),
                target[2] + distance * elevation.cos() * azimuth.cos(),
            ]
        };
        let fov = self.rng.between(25.0, 45.0);
        let lens = if self.rng.chance(0.6) {
            json!({ "pinhole": { "fov": fov } })
        } else {
            json!({ "thin": { "fov": fov, "focus_distance": distance * self.scale * self.rng.between(0.8, 1.3), "defocus_angle": self.rng.between(0.2, 4.0) } })
        };
        let mut camera = json!({ "from": self.at(from(azimuth)), "at": self.at(target), "lens": lens });
        if self.moving {
            camera["shutter"] = json!({ "open": 0, "close": 1 });
            if self.rng.chance(0.3) {
                camera["shutter"]["curve"] = json!([[0, 0], [0.3, 1], [1, 0.2]]);
            }
            if self.rng.chance(0.3) {
                let end = from(azimuth + self.rng.between(-0.1, 0.1));
                camera["motion"] = json!([{ "time": 0 }, { "time": 1, "from": self.at(end) }]);
            }
        }
        camera
    }
}

#[path = "lights.rs"]
mod lights;
