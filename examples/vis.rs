use abbe::scene::geometry::Ray; use glam::*;
fn main(){
 let s=abbe::scene::resolve::load(std::path::Path::new("../shared/bench/s1_ball.json"),&[]).unwrap();
 let cam=&s.camera; let mut rng=12345u64; let mut r=||{rng=abbe::math::random::mix64(rng); (rng>>11) as f64/(1u64<<53) as f64};
 let (mut n,mut bad1,mut bad2)=(0,0,0);
 for _ in 0..2_000_000 {
  // through pixel region
  let film=dvec2(98.0+20.0*r(),139.0+12.0*r());
  let ray=cam.ray(film,[0.5;2]);
  let Some(h)=s.geometry.intersect(&ray,None,f64::INFINITY) else {continue};
  // floor point along the same ray
  let fy = -s.centre.y; let t=(fy-ray.origin.y)/ray.direction.y; let p=ray.origin+ray.direction*t;
  // shoot down to find floor hit
  let down=Ray{origin:p+dvec3(0.0,1e-3,0.0),direction:dvec3(0.0,-1.0,0.0)};
  let fh=s.geometry.intersect(&down,None,f64::INFINITY).unwrap();
  if fh.object!=0 {continue}
  n+=1;
  let si=cam.sight(fh.position,[0.5;2]).unwrap();
  let occ=s.geometry.occluded(&Ray{origin:fh.position,direction:si.direction},Some(fh.surface),None,si.distance);
  let seen=h.object==0;
  if seen && occ {bad1+=1} if !seen && !occ {bad2+=1; if bad2<5 {println!("{:?} {:?} obj {}",film,fh.position,h.object)}}
  let pix = film.y as u32*256+film.x as u32; if si.pixel!=pix {println!("pixel {} {}",si.pixel,pix)}
 }
 println!("{n} {bad1} {bad2}");
}
