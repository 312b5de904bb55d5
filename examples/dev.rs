use abbe::render::*;
use std::io::Write;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = abbe::scene::resolve::load(
        std::path::Path::new(&a[1]),
        &a[4..].iter().filter(|s| s.contains('=')).cloned().collect::<Vec<_>>(),
    )
    .unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(2)
    });
    let job = Job::new(scene).unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(2)
    });
    print!("{}", abbe::plan::explain::text(&job.scene, &job.plan, &job.rows, &job.budget));
    let integrator = if a.iter().any(|x| x == "path") { Integrator::Path } else { Integrator::Photon };
    let r = job
        .render(
            Request { integrator, stop: StopRules { passes: Some(a[3].parse().unwrap()), ..Default::default() } },
            &mut Unwatched,
        )
        .unwrap();
    println!("{}", serde_json::to_string_pretty(&r.stats).unwrap());
    let mut f = std::fs::File::create(&a[2]).unwrap();
    let mut v: Vec<u8> = vec![];
    for (i, p) in r.picture.xyz.iter().enumerate() {
        for c in p {
            v.extend((*c as f32).to_le_bytes());
        }
        v.extend(r.picture.noise[i].to_le_bytes());
        v.extend(r.picture.bias[i].to_le_bytes());
    }
    f.write_all(&v).unwrap();
}
