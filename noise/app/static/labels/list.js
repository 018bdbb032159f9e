export function mountList(element) { element.textContent = ""; return { refresh() {} }; }
