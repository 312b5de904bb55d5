//! The camera, its motion and its shutter in the scene file.

use crate::prelude::*;
use crate::{JsonPath, LensFile, PolarisingFilterFile, check};
use abbe_scene::motion::{AnimatedLookAt, LookAt};
use abbe_spectra::error::Result;
use glam::DVec3;

/// The camera: position, viewing direction, lens, shutter and motion.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Camera", example = json!({"from": [0, 1, 5], "at": [0, 0.5, 0], "up": [0, 1, 0],
    "lens": {"pinhole": {"fov": 35}}, "filter": {"polariser": {"axis": 90}}, "shutter": {"open": 0, "close": 0.02}, "motion": [{"time": 0}, {"time": 0.02,
    "from": [0, 1, 4.9]}]}))]
pub struct CameraFile {
    /// Position of the camera.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub from: [f64; 3],
    /// A point in the middle of the picture. It must differ from `from`.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// A direction that points up in the picture. It must not be parallel to the viewing direction.
    #[serde(default = "default_up")]
    #[schemars(extend("x-range" = "not zero"))]
    pub up: [f64; 3],
    /// The lens that projects the scene onto the sensor.
    pub lens: LensFile,
    /// A polarising filter before the lens.
    #[schemars(extend("x-default" = "no filter"))]
    pub filter: Option<PolarisingFilterFile>,
    /// The time during which the camera records. If the shutter is absent, the picture shows the
    /// scene at time 0.
    pub shutter: Option<ShutterFile>,
    /// Keyframes of the camera, in the order of their times. The motion between them is
    /// interpolated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<CameraKeyframeFile>,
}

fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// A keyframe of the camera. If a key is absent, it has the value of the camera.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Camera keyframe", example = json!({"time": 0.02, "from": [0, 1, 4.9], "at": [0, 0.5, 0],
    "up": [0, 1, 0]}))]
pub struct CameraKeyframeFile {
    /// Time of the keyframe, later than the time of the keyframe before it.
    #[schemars(extend("x-unit" = "s"))]
    pub time: f64,
    /// Position of the camera.
    #[schemars(extend("x-unit" = "scene unit", "x-default" = "`from` of the camera"))]
    pub from: Option<[f64; 3]>,
    /// A point in the middle of the picture.
    #[schemars(extend("x-unit" = "scene unit", "x-default" = "`at` of the camera"))]
    pub at: Option<[f64; 3]>,
    /// A direction that points up in the picture.
    #[schemars(extend("x-range" = "not zero", "x-default" = "`up` of the camera"))]
    pub up: Option<[f64; 3]>,
}

/// The time during which the camera records.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Shutter", example = json!({"open": 0, "close": 0.02,
    "curve": [[0, 0], [0.2, 1], [0.8, 1], [1, 0]]}))]
pub struct ShutterFile {
    /// Time at which the shutter opens.
    #[schemars(extend("x-unit" = "s"))]
    pub open: f64,
    /// Time at which the shutter closes.
    #[schemars(extend("x-unit" = "s", "x-range" = "≥ `open`"))]
    pub close: f64,
    /// Transmission of the shutter over time: pairs of a time and a transmission. Time 0 is `open`
    /// and time 1 is `close`. The times must rise, and at least one transmission must be above 0.
    #[schemars(length(min = 2), inner(inner(range(min = 0, max = 1))), extend("x-default" = "fully open"))]
    pub curve: Option<Vec<[f64; 2]>>,
}

impl CameraFile {
    /// Returns the motion through the keyframes in the scene's unit, or `None` if there are none.
    pub fn camera_motion(&self) -> Option<AnimatedLookAt> {
        AnimatedLookAt::new(self.motion.iter().map(|key| {
            let vector = |own: Option<[f64; 3]>, static_value: [f64; 3]| DVec3::from(own.unwrap_or(static_value));
            let (from, at, up) = (vector(key.from, self.from), vector(key.at, self.at), vector(key.up, self.up));
            (key.time, LookAt { from, at, up })
        }))
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { from, at: target, up, lens, filter, shutter, motion } = self;
        check::all([
            validate_pose(at, "at", [*from, *target, *up]),
            lens.validate(&at.key("lens")),
            filter.as_ref().map_or(Ok(()), |filter| filter.validate(&at.key("filter"))),
            shutter.as_ref().map_or(Ok(()), |shutter| shutter.validate(&at.key("shutter"))),
        ])?;
        let at = at.key("motion");
        check::rising(&at, motion.iter().map(|key| key.time), Some("time"))?;
        for (i, key) in motion.iter().enumerate() {
            let last_written = if key.at.is_some() { "at" } else { "from" };
            let pose = [key.from.unwrap_or(*from), key.at.unwrap_or(*target), key.up.unwrap_or(*up)];
            validate_pose(&at.index(i), last_written, pose)?;
        }
        if let Some(time_s) = self.camera_motion().and_then(|motion| motion.degenerate_time_s()) {
            let what = format!(
                "found a motion in which, at {time_s:.3} s, the viewing direction is parallel to `up` or `at` equals `from`"
            );
            return Err(check::fault(&at, what, "a valid view at every time; add keyframes in between"));
        }
        Ok(())
    }
}

/// Checks that `from` and `at` differ and that `up` is not parallel to the viewing direction. If
/// the two points are equal, the error names the key `key`.
fn validate_pose(camera: &JsonPath, key: &str, [from, at, up]: [[f64; 3]; 3]) -> Result<()> {
    check::direction(&camera.key("up"), up)?;
    let (key, value, other_key, other) = if key == "at" { ("at", at, "from", from) } else { ("from", from, "at", at) };
    check::apart(&camera.key(key), value, other_key, other)?;
    let view = (DVec3::from_array(at) - DVec3::from_array(from)).normalize_or_zero();
    let sine = view.cross(DVec3::from_array(up).normalize_or_zero()).length();
    if sine > 1e-9 {
        return Ok(());
    }
    let found = format!("found {}, which is parallel to the viewing direction", check::triple(up));
    Err(check::fault(&camera.key("up"), found, "a direction that is not parallel to it"))
}

impl ShutterFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { open, close, curve } = self;
        let allowed = format!("a time of at least {}, when it opens", check::number(*open));
        check::rule(&at.key("close"), *close, close >= open, &allowed)?;
        let Some(curve) = curve else { return Ok(()) };
        let at = at.key("curve");
        check::entries(&at, curve.len(), 2, "at least 2 pairs of time and transmission")?;
        for (i, &[time, transmission]) in curve.iter().enumerate() {
            check::fraction(&at.index(i).index(0), time)?;
            check::fraction(&at.index(i).index(1), transmission)?;
        }
        let rising = curve.windows(2).position(|pair| pair[1][0] <= pair[0][0]);
        if let Some(i) = rising {
            let allowed = format!("a number above {}", check::number(curve[i][0]));
            return check::rule(&at.index(i + 1).index(0), curve[i + 1][0], false, &allowed);
        }
        if curve.iter().all(|point| point[1] == 0.0) {
            return Err(check::fault(&at, "found a shutter that never lets light through", "a transmission above 0"));
        }
        Ok(())
    }
}
