use tests::orders;
#[test]
fn a() { for c in [0.2,0.3] {let t = std::time::Instant::now();
 for r in orders::rotating_gaussian(c, &[32,64,128]) { println!("{c} {r}"); }; println!("{:?}", t.elapsed()); }}
#[test]
fn b() { for r in orders::heat_space(&[16,32,64]) { println!("{r}"); }
 for r in orders::heat_time(16) { println!("{r}"); } }
