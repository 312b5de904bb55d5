//! Photon tracing, by the renderer and by hand.

use super::scenes::{Harvest, Prepared};
use abbe_optics::bsdf::{Bsdf, InterfaceIors, TransportMode};
use abbe_scene::geometry::{Ray, SurfaceId};
use abbe_scene::light::LeRandoms;
use abbe_spectra::spectrum::{LANES, Lanes};
use abbe_transport::emit::{Aim, PhotonSource};
use abbe_transport::map::{Photon, PhotonPower};

/// Photons with their positions, as the photon map expects them.
pub(crate) type StoredPhotons = Vec<(Photon, [f32; 3])>;

/// Traces photons as the renderer does.
pub(crate) fn general(prepared: &Prepared, count: u64) -> StoredPhotons {
    let Harvest { indirect, .. } = prepared.harvest(count);
    indirect
}

/// Traces photons by hand: one light, opaque walls that scatter or absorb, clear air, and four
/// wavelengths along whole paths.
pub(crate) fn plain(prepared: &Prepared, count: u64) -> StoredPhotons {
    let scene = &prepared.scene;
    let (mut kept, mut absorbed, mut escaped) = (StoredPhotons::new(), vec![0.0; scene.materials.len()], 0.0);
    let (mut emitted, mut sampling) = (0.0, 0.0);
    prepared.with_source(count, |source: &PhotonSource<'_>| {
        let points = source.points();
        let aim = Aim::plain();
        let sides = InterfaceIors { here: &scene.air, there: &scene.air };
        for index in 0..count {
            let mut stream = source.streams.path(index);
            let u = points.point(index as u32);
            let mut u_light = u[1];
            let number = source.strata.choice.sample(&mut u_light);
            let light = &scene.lights[number];
            let (aim, density) = aim.sample([u[2], u[3]]);
            let emission = light.sample_le(scene.extent(), LeRandoms { aim, rest: [u[4], u[5], u[6]] });
            let flux = emission.flux_w / (count as f64 * source.strata.choice.probability(number) * density);
            let (mut nm, mut power): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let (drawn, pdf) = light.wavelengths.sample((u[0] + k as f64) / LANES as f64);
                nm[k] = drawn;
                power[k] = light.spd_at(emission.spd, drawn) / (pdf * LANES as f64) * flux;
            }
            let code = source.spectra.code(number, u[0]);
            emitted += power.iter().sum::<f64>();
            let mut ray = Ray { origin: emission.origin, direction: emission.direction };
            let mut from: Option<SurfaceId> = emission.from;
            let mut scattered_before = false;
            loop {
                stream.uniform();
                let Some(hit) = scene.geometry.intersect(&ray, from, f64::INFINITY) else {
                    escaped += power.iter().sum::<f64>();
                    break;
                };
                let material = scene.objects[hit.object as usize].material;
                let surface = scene.materials[material].surface.at(0.0);
                let Bsdf::Diffuse(_) = surface.model else {
                    absorbed[material] += power.iter().sum::<f64>();
                    break;
                };
                let to_light = -ray.direction;
                if scattered_before {
                    let facing = if to_light.dot(hit.normal) >= 0.0 { hit.normal } else { -hit.normal };
                    let photon = Photon::new(PhotonPower::new(code, power, None, stream.uniform()), to_light, facing);
                    kept.push((photon, hit.position.as_vec3().to_array()));
                }
                let frame = hit.frame();
                let wo = frame.to_local(to_light);
                let u = stream.triple();
                let Some(drawn) = surface.sample(wo, sides, nm[0], u) else {
                    absorbed[material] += power.iter().sum::<f64>();
                    break;
                };
                let direction = frame.to_world(drawn.wi);
                assert!(
                    hit.leads_back(ray.direction, direction),
                    "the shading normals of these walls are the geometric normals"
                );
                let correction = hit.adjoint_correction(&frame, to_light, direction);
                let before: f64 = power.iter().sum();
                let (mut weights, mut lost) = (0.0, 0.0);
                for k in 0..LANES {
                    let weight =
                        surface.eval_sample(wo, &drawn, sides, TransportMode::Importance, nm[k]) / drawn.probability;
                    lost += power[k] * surface.absorbed_fraction(wo, &drawn, sides, nm[k]);
                    power[k] *= weight * correction;
                    weights += weight * correction;
                }
                absorbed[material] += lost;
                let survival = (weights / LANES as f64).min(1.0);
                let survives = survival > 0.0 && stream.uniform() < survival;
                power = power.map(|power| if survives { power / survival } else { 0.0 });
                sampling += power.iter().sum::<f64>() + lost - before;
                if !survives {
                    break;
                }
                ray = Ray { origin: hit.position, direction };
                (from, scattered_before) = (Some(hit.surface), true);
            }
        }
    });
    let ended = absorbed.iter().sum::<f64>() + escaped;
    assert!((emitted + sampling - ended).abs() < 1e-9 * emitted.max(1.0), "the energy balance by hand fails");
    kept
}
