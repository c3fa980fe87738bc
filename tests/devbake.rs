//! dev only, not committed
use crease::bake::*; use crease::format::*; use crease::garment::Garment; use crease::fabric::*; use crease::wear::*;
struct O{t:std::time::Instant,dir:String,n:usize,tri:Vec<[crease::mesh::PointIndex;3]>,last:u64,check:bool}
impl Observer for O{
 fn progress(&mut self,p:&Progress){ self.last+=1; if self.last%10==0{ eprintln!("{:.1}s wall t={:.3}/{:.1} {} steps {} h={:.4} its {} ev {:?}",self.t.elapsed().as_secs_f64(),p.time,p.total,p.stage,p.steps,p.step,p.iterations,p.events);} }
 fn frame(&mut self,x:&[crease::math::Vec3])->crease::Result<()>{ if self.check {let c=crease::mesh::crossings::crossings(x,&self.tri).len(); if c>0 {eprintln!("CROSSINGS {c} in frame {}",self.n);}} std::fs::write(format!("{}/f{:04}.obj",self.dir,self.n),frame_obj(x,&self.tri)).unwrap(); self.n+=1; Ok(())}
}
#[test] fn devbake(){
 let v:Vec<String>=std::env::var("ARGS").unwrap().split_whitespace().map(String::from).collect();
 let bytes=std::fs::read(&v[0]).unwrap();
 let ro=ReadOptions{unit_m:v.get(4).and_then(|s|s.parse().ok()),garment:v.get(5).cloned(),..Default::default()};
 let (asset,f)=read_asset(&v[0],&bytes,&ro,&mut |_|panic!()).unwrap(); for x in &f{eprintln!("{x:?}");}
 let (g,f)=Garment::from_asset(&asset).unwrap(); for x in &f{eprintln!("{x:?}");}
 let script=WearScript::parse(&v[1],&std::fs::read_to_string(&v[1]).unwrap()).unwrap();
 let fabric=Fabric::preset(DEFAULT_FABRIC).unwrap();
 let c0=crease::mesh::crossings::crossings(&g.points,&g.triangles).len();
 eprintln!("points {} triangles {} crossings {c0}",g.points.len(),g.triangles.len());
 let mut o=O{t:std::time::Instant::now(),dir:v[2].clone(),n:0,tri:g.triangles.clone(),last:0,check:true};
 let opt=BakeOptions{frames_per_second:v[3].parse().unwrap(),..Default::default()};
 let t=std::time::Instant::now();
 let b=bake(&g,&fabric,&script,&v[1],&opt,&mut o).unwrap();
 eprintln!("{:#?}",b.report); eprintln!("wall {}",t.elapsed().as_secs_f64());
 let m=b.worn.displacement.iter().map(|d|d.norm()).fold(0.0,f64::max); eprintln!("max disp {m}");
 let r=&b.worn.memory; let mx=r.rest_angle.iter().zip(&r.source_angle).map(|(a,b)|(a-b).abs()).fold(0.0,f64::max).to_degrees(); eprintln!("max rest change deg {mx} max s {}",r.stiffness_ratio.iter().cloned().fold(0.0,f64::max));
}
