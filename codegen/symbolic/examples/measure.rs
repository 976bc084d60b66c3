//! Operation counts of the ballbot with arms before and after optimisation.
#![allow(clippy::print_stdout)]

#[path = "../tests/support/mod.rs"]
mod support;

use shapebot_symbolic::{Effort, Graph, Id, count, normal_form, optimise};
use std::time::Instant;

fn main() {
    for baked in [true, false] {
        let mut model = support::Model::new(baked);
        let m = model.mass_matrix();
        println!("parameters {}", if baked { "as numbers" } else { "as symbols" });
        report("M", &model.graph, &support::upper(&m));
        let bias = model.bias(&m);
        report("C qd", &model.graph, &bias);
    }
}

fn report(name: &str, graph: &Graph, ids: &[Id]) {
    println!("  {name}: given {}", count(graph, ids).flops());
    let start = Instant::now();
    if let Some(polynomials) = normal_form::expand(graph, ids, 4000) {
        let elapsed = start.elapsed();
        let (form, form_ids) = polynomials.rebuild();
        println!(
            "    normal form {} ({} terms, {elapsed:.1?})",
            count(&form, &form_ids).flops(),
            polynomials.terms()
        );
    }
    for effort in [Effort::Quick, Effort::Thorough] {
        let start = Instant::now();
        let (best, best_ids) = optimise(graph, ids, effort);
        println!("    {effort:?} {:?} ({:.1?})", count(&best, &best_ids).flops(), start.elapsed());
    }
}
