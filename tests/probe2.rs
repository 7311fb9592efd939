mod reference;
use flexbody::integrate::*;
#[test]
fn probe() {
    let (model, _) = reference::load("trebuchet");
    for n in [800, 1600] {
    let mut s = Settings::steps(Method::Radau{stages:2}, n);
    s.samples = Samples::Uniform(1);
    println!("{:?}", simulate(&model, 2.0, &s).err());}
}
