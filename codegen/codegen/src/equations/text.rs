//! The equations as plain text.

use super::Subject;
use super::layout::Term;
use super::render::{Notation, Printer, is_zero};
use super::sheet::{Factored, Sheet, is_one};
use std::fmt::Write as _;

/// Lines are broken at this width where a sum allows it.
const WIDTH: usize = 100;

pub(super) fn print(subject: Subject<'_>) -> String {
    let Subject { model, equations, certificate } = subject;
    let mut sheet = Sheet::new(model, equations, certificate);
    let printer = Printer::new(model, &mut sheet.forms, Notation::Text);
    let mut page = Page { printer, out: String::new() };
    let names = &certificate.coordinates;
    page.line(&format!("{}: M(q) q'' + C(q, q') q' + G(q) = B tau", model.name));
    page.line(&format!("  q = [{}]", names.join(", ")));
    page.energies(&sheet);
    page.heading("Mass matrix M (symmetric; entries not listed are zero)");
    for (i, row) in sheet.mass.iter().enumerate() {
        for (j, entry) in row.iter().enumerate().skip(i) {
            page.entry(&format!("M[{}, {}]", names[i], names[j]), entry);
        }
    }
    page.column("Coriolis and centrifugal forces C q'", "Cq'", names, &sheet.bias);
    page.column("Gravity and springs G", "G", names, &sheet.gravity);
    page.input(subject, &sheet);
    page.shape_map(subject, &sheet);
    if !sheet.shared.is_empty() {
        page.heading("where");
        for (k, term) in sheet.shared.iter().enumerate() {
            let name = page.printer.shared(k);
            page.formula(&name, term);
        }
    }
    page.out
}

struct Page {
    printer: Printer,
    out: String,
}

impl Page {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{}", text.trim_end());
    }

    fn heading(&mut self, text: &str) {
        self.line("");
        self.line(text);
    }

    fn formula(&mut self, name: &str, term: &Term) {
        let mut current = format!("  {name} =");
        let indent = " ".repeat(6);
        for piece in self.printer.pieces(term) {
            if current.len() + piece.len() + 1 > WIDTH && current.len() > indent.len() {
                self.line(&current);
                current.clone_from(&indent);
                current.push_str(&piece);
            } else {
                current.push(' ');
                current.push_str(&piece);
            }
        }
        self.line(&current);
    }

    /// A formula, unless it is zero.
    fn entry(&mut self, name: &str, term: &Term) -> bool {
        let shown = !is_zero(term);
        if shown {
            self.formula(name, term);
        }
        shown
    }

    fn energies(&mut self, sheet: &Sheet) {
        self.heading("Energies");
        match &sheet.kinetic {
            Some(term) => self.formula("T", term),
            None => self.line("  T = 1/2 q'^T M q'"),
        }
        self.formula("V", &sheet.potential);
    }

    fn column(&mut self, title: &str, symbol: &str, names: &[String], terms: &[Term]) {
        self.heading(title);
        let mut any = false;
        for (name, term) in names.iter().zip(terms) {
            any |= self.entry(&format!("{symbol}[{name}]"), term);
        }
        if !any {
            self.line("  none");
        }
    }

    fn input(&mut self, subject: Subject<'_>, sheet: &Sheet) {
        self.heading("Input matrix B (entries not listed are zero)");
        let actuators = &subject.model.actuators;
        for (i, row) in sheet.input.iter().enumerate() {
            for (actuator, entry) in actuators.iter().zip(row) {
                self.entry(
                    &format!("B[{}, {}]", subject.certificate.coordinates[i], actuator.name),
                    entry,
                );
            }
        }
    }

    fn shape_map(&mut self, subject: Subject<'_>, sheet: &Sheet) {
        let names = &subject.certificate.coordinates;
        let n_x = subject.certificate.position_count;
        if !sheet.static_map.is_empty() {
            self.heading("Acceleration at constant shape, q_x'' = Gamma'(q_s) (Eq. 15)");
            for (name, term) in names.iter().zip(&sheet.static_map) {
                self.formula(&format!("{name}''"), term);
            }
        }
        if let Some(gain) = &sheet.gain {
            self.heading("Linear map at the origin, q_x'' = K0_qs q_s (Eq. 16)");
            self.line(&format!("  q_x = [{}]", names[..n_x].join(", ")));
            self.line(&format!("  q_s = [{}]", names[n_x..].join(", ")));
            self.matrix("K0_qs", gain);
        }
        if let Some(gain) = &sheet.inverse_gain {
            self.heading("Its inverse, q_s = K0_qx q_x'' (Eq. 19)");
            self.matrix("K0_qx", gain);
        }
    }

    fn matrix(&mut self, name: &str, gain: &Factored) {
        let row = |row: &Vec<Term>| {
            row.iter().map(|t| self.printer.term(t)).collect::<Vec<_>>().join(", ")
        };
        let rows = gain.rows.iter().map(row).collect::<Vec<_>>();
        let factor = if is_one(&gain.factor) {
            String::new()
        } else {
            format!("{} * ", self.printer.term(&gain.factor))
        };
        if let [only] = &gain.rows[..]
            && only.len() == 1
            && is_one(&only[0])
        {
            self.formula(name, &gain.factor);
            return;
        }
        let short = format!("  {name} = {factor}[{}]", rows.join("; "));
        if short.len() <= WIDTH {
            self.line(&short);
            return;
        }
        self.line(&format!("  {name} = {factor}"));
        let last = rows.len() - 1;
        for (k, row) in rows.iter().enumerate() {
            let (open, close) = (if k == 0 { "[" } else { " " }, if k == last { "]" } else { ";" });
            self.line(&format!("      {open}{row}{close}"));
        }
    }
}
