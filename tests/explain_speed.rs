//! The response time of `abbe explain`. It is an executable of its own, so that no other test runs
//! at the same time.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[expect(dead_code, reason = "other tests use the rest")]
#[path = "cli/abbe_command/mod.rs"]
mod abbe_command;

use abbe_command::abbe;

#[test]
fn explaining_a_large_mesh_adds_half_to_reading() {
    // A ball of 2 × 300 × 300 triangles on a grid of latitudes and longitudes, as binary STL.
    const SIDE: u32 = 300;
    let point = |i: u32, j: u32| {
        let [theta, phi] = [i, 2 * (j % SIDE)].map(|k| std::f64::consts::PI * f64::from(k) / f64::from(SIDE));
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()].map(|x| x as f32)
    };
    let mut stl = vec![0_u8; 80];
    stl.extend((2 * SIDE * SIDE).to_le_bytes());
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| point(i, j));
        for triangle in [[a, b, c], [a, c, d]] {
            let numbers = [[0.0; 3], triangle[0], triangle[1], triangle[2]].concat();
            stl.extend(numbers.into_iter().flat_map(f32::to_le_bytes).chain([0, 0]));
        }
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.stl"), stl).unwrap();
    let scene = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 300, "height": 200},
  "materials": {"glass": {"dielectric": {"ior": "N-BK7"}}, "grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [{"shape": {"mesh": {"path": "ball.stl"}}, "material": "glass"},
              {"shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey", "transform": [{"translate": [0, -1, 0]}]}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}]
}"#;
    std::fs::write(folder.path().join("ball.json"), scene).unwrap();
    // `abbe check` reads the mesh and builds its tree, so a machine's speed cancels in the ratio.
    let once = |command: &str| {
        let start = std::time::Instant::now();
        let said = abbe(folder.path(), &[command, "ball.json"]);
        assert_eq!(said.status, 0, "{}", said.err);
        assert!(command == "check" || said.out.contains("dispersion      on"), "{}", said.out);
        start.elapsed().as_secs_f64()
    };
    // The fastest of three runs, because other work only slows a program down.
    let fastest = |command: &str| (0..3).map(|_| once(command)).fold(f64::INFINITY, f64::min);
    let (check, explain) = (fastest("check"), fastest("explain"));
    println!("180,000 triangles are explained in {explain:.2} s and checked in {check:.2} s");
    assert!(explain < 1.5 * check, "{explain} s against {check} s");
}
