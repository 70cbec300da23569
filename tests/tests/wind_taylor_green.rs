use tests::orders;
#[test]
fn a() { let t = std::time::Instant::now();
 for c in [0.25,0.4] { for r in orders::advection_and_time(c, &[24, 48, 96]) { println!("{c} {r}"); }; println!("{:?}", t.elapsed()); } }
#[test]
fn c() { let t = std::time::Instant::now();for r in orders::time(16) {println!("{r}"); } ; println!("{:?}", t.elapsed()); }
