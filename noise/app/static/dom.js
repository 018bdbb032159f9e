// Creation of nodes, and actions deferred until a view is shown.

export function made(tag, properties = {}, ...children) {
  const { data, ...rest } = properties;
  const node = Object.assign(document.createElement(tag), rest);
  Object.assign(node.dataset, data);
  node.append(...children);
  return node;
}

export const stylesheet = (address) => document.head.append(made("link", { rel: "stylesheet", href: address.href }));

// Act now if a node is in the page, else when its view is shown.
export function onceShown(node, act) {
  if (node.isConnected) act();
  else document.addEventListener("view-shown", () => onceShown(node, act), { once: true });
}
