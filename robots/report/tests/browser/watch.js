// Notes everything that goes wrong in the page.
window.complaints = [];
for (const name of ["error", "warn"]) {
  console[name] = (...words) => window.complaints.push(words.join(" "));
}
addEventListener("error", (event) => window.complaints.push(event.message || `not loaded: ${event.target.tagName}`), true);
addEventListener("unhandledrejection", (event) => window.complaints.push(String(event.reason)));
document.addEventListener("securitypolicyviolation", (event) => window.complaints.push(event.violatedDirective));
