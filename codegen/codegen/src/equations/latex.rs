//! The equations as a LaTeX fragment.

use super::Subject;
use super::layout::Term;
use super::names::latex_name;
use super::render::{Notation, Printer, is_zero};
use super::sheet::{Factored, Sheet, is_one};
use std::fmt::Write as _;

/// Characters of source after which a line is broken where a sum allows it.
const WIDTH: usize = 150;

pub(super) fn print(subject: Subject<'_>) -> String {
    let Subject { model, equations, certificate } = subject;
    let mut sheet = Sheet::new(model, equations, certificate);
    let printer = Printer::new(model, &mut sheet.forms, Notation::Latex);
    let mut page = Page { printer, out: String::new() };
    let names: Vec<String> = certificate.coordinates.iter().map(|c| latex_name(c)).collect();
    page.line(&format!("% {}: equations of motion. Needs \\usepackage{{amsmath}}.", model.name));
    page.line("\\begin{equation}");
    page.line(&format!(
        "  M(q)\\,\\ddot{{q}} + C(q,\\dot{{q}})\\,\\dot{{q}} + G(q) = B\\,\\tau, \\qquad q = \\begin{{bmatrix}} {} \\end{{bmatrix}}^{{T}}",
        names.join(" & ")
    ));
    page.line("\\end{equation}");
    page.energies(&sheet);
    let mut mass = Vec::new();
    for (i, row) in sheet.mass.iter().enumerate() {
        for (j, entry) in row.iter().enumerate().skip(i) {
            mass.push((format!("M_{{{} {}}}", names[i], names[j]), entry));
        }
    }
    page.section("Mass matrix, symmetric; entries that are not listed are zero", &mass);
    page.section(
        "Coriolis and centrifugal forces",
        &column("\\left(C\\dot{q}\\right)", &names, &sheet.bias),
    );
    page.section("Gravity and springs", &column("G", &names, &sheet.gravity));
    page.input(&names, &sheet);
    page.shape_map(subject, &names, &sheet);
    let shared: Vec<(String, &Term)> =
        sheet.shared.iter().enumerate().map(|(k, term)| (page.printer.shared(k), term)).collect();
    page.section("Shared values", &shared);
    page.out
}

fn column<'a>(symbol: &str, names: &[String], terms: &'a [Term]) -> Vec<(String, &'a Term)> {
    names.iter().zip(terms).map(|(name, term)| (format!("{symbol}_{{{name}}}"), term)).collect()
}

struct Page {
    printer: Printer,
    out: String,
}

impl Page {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{}", text.trim_end());
    }

    /// Formulas that are not zero, aligned at the equals sign; nothing if there are none.
    fn section(&mut self, title: &str, entries: &[(String, &Term)]) {
        let shown: Vec<&(String, &Term)> =
            entries.iter().filter(|(_, term)| !is_zero(term)).collect();
        if shown.is_empty() {
            return;
        }
        self.line(&format!("% {title}"));
        self.line("\\begin{align*}");
        let last = shown.len() - 1;
        for (k, (name, term)) in shown.into_iter().enumerate() {
            self.formula(name, term, if k == last { "" } else { " \\\\" });
        }
        self.line("\\end{align*}");
    }

    fn energies(&mut self, sheet: &Sheet) {
        let mut energies = Vec::new();
        match &sheet.kinetic {
            Some(kinetic) => energies.push(("T".to_owned(), kinetic)),
            None => self.line("\\begin{equation*}\n  T = \\frac{1}{2} \\dot{q}^{T} M(q)\\,\\dot{q}\n\\end{equation*}"),
        }
        energies.push(("V".to_owned(), &sheet.potential));
        self.section("Energies", &energies);
    }

    fn formula(&mut self, name: &str, term: &Term, end: &str) {
        let mut current = format!("  {name} ={{}}& ");
        let mut empty = true;
        for piece in self.printer.pieces(term) {
            if !empty && current.len() + piece.len() > WIDTH {
                self.line(&format!("{current} \\\\"));
                current = "    & \\quad {}".to_owned();
            } else if !empty {
                current.push(' ');
            }
            current.push_str(&piece);
            empty = false;
        }
        self.line(&format!("{current}{end}"));
    }

    fn input(&mut self, names: &[String], sheet: &Sheet) {
        let width = sheet.input.first().map_or(0, Vec::len);
        if width == 0 || names.is_empty() {
            return;
        }
        let rows = self.rows(&sheet.input);
        self.line("% Input matrix");
        self.line("\\begin{equation*}");
        self.line(&format!("  B = \\begin{{bmatrix}} {rows} \\end{{bmatrix}}"));
        self.line("\\end{equation*}");
    }

    fn rows(&self, rows: &[Vec<Term>]) -> String {
        let row = |row: &Vec<Term>| {
            row.iter().map(|t| self.printer.term(t)).collect::<Vec<_>>().join(" & ")
        };
        rows.iter().map(row).collect::<Vec<_>>().join(" \\\\ ")
    }

    fn shape_map(&mut self, subject: Subject<'_>, names: &[String], sheet: &Sheet) {
        let n_x = subject.certificate.position_count;
        let accelerations = subject.certificate.coordinates[..n_x]
            .iter()
            .map(|name| super::names::latex_accented("\\ddot", name))
            .zip(&sheet.static_map)
            .collect::<Vec<_>>();
        self.section("Acceleration at constant shape, Gamma'(q_s) (Eq. 15)", &accelerations);
        let vector = |list: &[String]| {
            format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}^{{T}}", list.join(" & "))
        };
        let vectors =
            format!("q_x = {}, \\quad q_s = {}", vector(&names[..n_x]), vector(&names[n_x..]));
        if let Some(gain) = &sheet.gain {
            self.matrix("Linear map at the origin (Eq. 16)", "K^0_{q_s}", gain, &vectors);
        }
        if let Some(gain) = &sheet.inverse_gain {
            self.matrix("Its inverse (Eq. 19)", "K^0_{q_x}", gain, "");
        }
    }

    fn matrix(&mut self, title: &str, name: &str, gain: &Factored, vectors: &str) {
        let factor =
            if is_one(&gain.factor) { String::new() } else { self.printer.term(&gain.factor) };
        let rows = self.rows(&gain.rows);
        let scalar = matches!(&gain.rows[..], [only] if only.len() == 1 && is_one(&only[0]));
        let body = if scalar {
            String::new()
        } else {
            format!("\\begin{{bmatrix}}{rows}\\end{{bmatrix}}")
        };
        let factor = if scalar && factor.is_empty() { "1".to_owned() } else { factor };
        self.line(&format!("% {title}"));
        self.line("\\begin{equation*}");
        self.line(&format!("  {name} = {factor}{body}"));
        if !vectors.is_empty() {
            self.line("\\end{equation*}");
            self.line("\\begin{equation*}");
            self.line(&format!("  {vectors}"));
        }
        self.line("\\end{equation*}");
    }
}
