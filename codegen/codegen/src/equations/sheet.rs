//! Which formulas are printed, and in which form: the shortest that is shown to be right.

use super::forms::Forms;
use super::fraction::{Fraction, common_factor, solve};
use super::layout::Tree;
use super::layout::{Term, plus};
use super::polynomial::TooLarge;
use crate::derive::Equations;
use crate::proof::{Certificate, determinant};
use num_rational::BigRational;
use num_traits::Zero;
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::{Id, Node, Symbol, Tangent, needed, substitute};
use std::collections::{BTreeMap, HashMap};

/// A normal form of more terms is printed by shared values instead.
const READABLE: usize = 64;

/// All formulas of a model.
pub(super) struct Sheet {
    pub(super) forms: Forms,
    /// Shared values `a_1`, … that formulas refer to, in order.
    pub(super) shared: Vec<Term>,
    /// T, if it fits on a few lines; it is ½ q̇ᵀ M q̇ in any case.
    pub(super) kinetic: Option<Term>,
    pub(super) potential: Term,
    /// M, n × n.
    pub(super) mass: Vec<Vec<Term>>,
    /// C q̇.
    pub(super) bias: Vec<Term>,
    /// G.
    pub(super) gravity: Vec<Term>,
    /// B, one column per actuator.
    pub(super) input: Vec<Vec<Term>>,
    /// Γ′ (Eq. 15).
    pub(super) static_map: Vec<Term>,
    /// K⁰_qs (Eq. 16).
    pub(super) gain: Option<Factored>,
    /// K⁰_qx (Eq. 19), where n_s = n_x.
    pub(super) inverse_gain: Option<Factored>,
}

/// A factor times a matrix.
pub(super) struct Factored {
    /// The common factor; one where there is none.
    pub(super) factor: Term,
    /// What is left of the entries.
    pub(super) rows: Vec<Vec<Term>>,
}

/// Values before they are arranged.
pub(super) struct Wanted {
    pub(super) static_map: Vec<Id>,
    pub(super) coupling: Vec<Vec<Id>>,
    pub(super) stiffness: Vec<Vec<Id>>,
}

impl Sheet {
    pub(super) fn new(model: &Model, equations: &Equations, certificate: &Certificate) -> Self {
        let mut graph = equations.graph.clone();
        let wanted = certificate.shape_map.is_some().then(|| wanted(&mut graph, equations));
        // What matters most comes first: large models run out of work for normal forms.
        let mut ids: Vec<Id> = vec![equations.potential];
        ids.extend(equations.input.iter().flatten());
        ids.extend(&equations.gravity);
        ids.extend(equations.mass.iter().flatten());
        ids.extend(&equations.bias);
        if let Some(wanted) = &wanted {
            ids.extend(&wanted.static_map);
            ids.extend(wanted.coupling.iter().chain(&wanted.stiffness).flatten());
        }
        let all = [&ids[..], &[equations.kinetic]].concat();
        let mut forms = Forms::new(model, graph, &all);
        let gains = wanted.as_ref().and_then(|w| gains(&mut forms, equations, certificate, w).ok());
        let (static_forms, gain, inverse_gain) = gains.unwrap_or_default();
        let kinetic = forms.kinetic(equations);
        if static_forms.is_some() {
            // Γ′ is printed already.
            ids.retain(|id| wanted.as_ref().is_none_or(|w| !w.static_map.contains(id)));
        }
        let mut writer = Writer::new(&mut forms, &ids);
        let potential = writer.term(equations.potential);
        let mass = equations.mass.iter().map(|row| writer.terms(row)).collect();
        let bias = writer.terms(&equations.bias);
        let gravity = writer.terms(&equations.gravity);
        let input = equations.input.iter().map(|row| writer.terms(row)).collect();
        let static_map = match (&wanted, static_forms) {
            (Some(w), Some(terms)) if w.static_map.len() == terms.len() => terms,
            (Some(w), _) => writer.terms(&w.static_map),
            (None, _) => Vec::new(),
        };
        let shared = writer.definitions();
        Self {
            forms,
            shared,
            kinetic,
            potential,
            mass,
            bias,
            gravity,
            input,
            static_map,
            gain,
            inverse_gain,
        }
    }
}

/// Γ′ by Cramer's rule, M_{u,x} and ∂G_u/∂q_s at the origin.
pub(super) fn wanted(graph: &mut shapebot_symbolic::Graph, equations: &Equations) -> Wanted {
    let rows = equations.unactuated();
    let n_x = equations.position_count;
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let gravity: Vec<Id> = rows.iter().map(|&u| equations.gravity[u]).collect();
    let block: Vec<Vec<Id>> = rows.iter().map(|&u| equations.mass[u][..n_x].to_vec()).collect();
    let det = determinant(graph, &block);
    let mut static_map = Vec::new();
    for x in 0..n_x {
        let mut replaced = block.clone();
        for (row, &g) in replaced.iter_mut().zip(&gravity) {
            row[x] = g;
        }
        let minor = determinant(graph, &replaced);
        let quotient = graph.div(minor, det);
        static_map.push(graph.neg(quotient));
    }
    let mut stiffness = vec![Vec::new(); rows.len()];
    for s in n_x..equations.len() {
        let mut slope = Tangent::partial(graph, Symbol::Coordinate(index(s)));
        for (row, &g) in stiffness.iter_mut().zip(&gravity) {
            row.push(slope.of(graph, g));
        }
    }
    let zero = graph.zero();
    let origin: HashMap<Id, Id> =
        (0..equations.len()).map(|i| (graph.symbol(Symbol::Coordinate(index(i))), zero)).collect();
    let at_origin = |graph: &mut shapebot_symbolic::Graph, matrix: &[Vec<Id>]| {
        matrix.iter().map(|row| substitute(graph, row, &origin)).collect()
    };
    Wanted {
        static_map,
        coupling: at_origin(graph, &block),
        stiffness: at_origin(graph, &stiffness),
    }
}

type Gains = (Option<Vec<Term>>, Option<Factored>, Option<Factored>);

/// Γ′ and K⁰ by elimination between normal forms.
fn gains(
    forms: &mut Forms,
    equations: &Equations,
    certificate: &Certificate,
    wanted: &Wanted,
) -> Result<Gains, TooLarge> {
    let coupling = forms.matrix(&wanted.coupling)?;
    let stiffness = forms.matrix(&wanted.stiffness)?;
    let ring = forms.ring.clone();
    let mut gain = solve(&ring, coupling.clone(), stiffness.clone())?;
    for entry in gain.iter_mut().flatten() {
        *entry = entry.neg();
    }
    let invertible = certificate.shape_map.as_ref().is_some_and(|map| map.invertible);
    let inverse = if invertible {
        let n_x = equations.position_count;
        let unit = |i: usize, j: usize| {
            if i == j { ring.one() } else { ring.constant(BigRational::zero()) }
        };
        let identity =
            (0..n_x).map(|i| (0..n_x).map(|j| Fraction::of(&ring, unit(i, j))).collect()).collect();
        solve(&ring, gain.clone(), identity).ok()
    } else {
        None
    };
    let static_map = static_map(forms, equations, wanted).ok();
    let gain = forms.factored(&gain)?;
    let inverse = inverse.and_then(|k| forms.factored(&k).ok());
    Ok((static_map, Some(gain), inverse))
}

/// Γ′ in lowest terms, if it is readable and the graph confirms it.
fn static_map(
    forms: &mut Forms,
    equations: &Equations,
    wanted: &Wanted,
) -> Result<Vec<Term>, TooLarge> {
    let rows = equations.unactuated();
    let n_x = equations.position_count;
    let block: Vec<Vec<Id>> = rows.iter().map(|&u| equations.mass[u][..n_x].to_vec()).collect();
    let gravity: Vec<Vec<Id>> = rows.iter().map(|&u| vec![equations.gravity[u]]).collect();
    let (block, gravity) = (forms.matrix(&block)?, forms.matrix(&gravity)?);
    let entries = block.iter().flatten().map(|entry| {
        let p = &entry.numerator;
        p.without(&p.common_monomial()).primitive()
    });
    forms.factors = entries.filter(|p| p.terms.len() > 1).collect();
    let ring = forms.ring.clone();
    let mut terms = Vec::new();
    for (entry, &value) in solve(&ring, block, gravity)?.iter().flatten().zip(&wanted.static_map) {
        let form = entry.neg();
        if form.size() > READABLE || forms.value(&form) != value {
            return Err(TooLarge);
        }
        terms.push(forms.arrange(&form));
    }
    Ok(terms)
}

impl Forms {
    fn matrix(&mut self, ids: &[Vec<Id>]) -> Result<Vec<Vec<Fraction>>, TooLarge> {
        ids.iter().map(|row| row.iter().map(|&id| self.of(id)).collect()).collect()
    }

    /// One factor in front of a matrix without denominators.
    fn factored(&mut self, matrix: &[Vec<Fraction>]) -> Result<Factored, TooLarge> {
        let ring = self.ring.clone();
        let (factor, rest) = common_factor(&ring, matrix)?;
        for (row, tops) in matrix.iter().zip(&rest) {
            for (entry, top) in row.iter().zip(tops) {
                let whole = factor.mul(&ring, &Fraction::of(&ring, top.clone()))?;
                if self.value(&whole) != self.value(entry) {
                    return Err(TooLarge);
                }
            }
        }
        let arrange = |row: &Vec<_>| row.iter().map(|p| self.arrange_polynomial(p)).collect();
        Ok(Factored { factor: self.arrange(&factor), rows: rest.iter().map(arrange).collect() })
    }
}

/// Decides value by value between normal form and shared values.
struct Writer<'a> {
    forms: &'a mut Forms,
    /// Short normal forms; `None` for what has none.
    short: HashMap<Id, Option<Fraction>>,
    /// Names of shared values, by the order of the graph.
    names: BTreeMap<Id, usize>,
}

impl<'a> Writer<'a> {
    fn new(forms: &'a mut Forms, ids: &[Id]) -> Self {
        // Values that do not fit on a line share their parts: find out which they are first.
        let short: HashMap<Id, Option<Fraction>> =
            ids.iter().map(|&id| (id, forms.short(id))).collect();
        let long: Vec<Id> = ids.iter().copied().filter(|id| short[id].is_none()).collect();
        let mut uses: HashMap<Id, usize> = HashMap::new();
        for id in needed(&forms.graph, &long, |x| forms.atom_of(x).is_some()) {
            for operand in forms.graph.node(id).operands().into_iter().flatten() {
                *uses.entry(operand).or_insert(0) += 1;
            }
        }
        let mut names = BTreeMap::new();
        for id in needed(&forms.graph, &long, |x| forms.atom_of(x).is_some()) {
            let often = uses.get(&id).copied().unwrap_or(0) > 1;
            if often && !forms.is_plain(id) {
                let next = names.len();
                names.insert(id, next);
            }
        }
        Self { forms, short, names }
    }

    fn terms(&mut self, ids: &[Id]) -> Vec<Term> {
        ids.iter().map(|&id| self.term(id)).collect()
    }

    fn term(&mut self, id: Id) -> Term {
        if let Some(Some(form)) = self.short.get(&id) {
            return self.forms.arrange(form);
        }
        let names: HashMap<Id, usize> = self.names.iter().map(|(&id, &k)| (id, k)).collect();
        self.forms.as_computed(id, &names)
    }

    fn definitions(&self) -> Vec<Term> {
        let names: HashMap<Id, usize> = self.names.iter().map(|(&id, &k)| (id, k)).collect();
        self.names.keys().map(|&id| self.forms.computed_node(id, &names)).collect()
    }
}

impl Forms {
    /// Whether a value is too simple for a name of its own: an atom, a number, a product of such.
    fn is_plain(&self, id: Id) -> bool {
        let simple = |x: Id| self.atom_of(x).is_some() || self.graph.as_constant(x).is_some();
        simple(id)
            || match *self.graph.node(id) {
                Node::Neg(_) => true,
                Node::Mul(a, b) | Node::Div(a, b) => simple(a) && simple(b),
                _ => false,
            }
    }

    /// T, if M is short enough for T to be so.
    fn kinetic(&mut self, equations: &Equations) -> Option<Term> {
        let mut size = 0;
        for &entry in equations.mass.iter().flatten() {
            size += self.of(entry).ok()?.size();
            if size > 2 * READABLE {
                return None;
            }
        }
        self.short(equations.kinetic).map(|form| self.arrange(&form))
    }

    /// The normal form, if it is short and the graph confirms it.
    fn short(&mut self, id: Id) -> Option<Fraction> {
        let form = self.of(id).ok()?;
        (form.size() <= READABLE && self.value(&form) == id).then_some(form)
    }
}

/// One, as a factor that is not printed.
pub(super) fn is_one(term: &Term) -> bool {
    *term == plus(Tree::Number(num_traits::One::one()))
}
