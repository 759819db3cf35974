import './theme.css';

import { mount } from 'svelte';

import App from './App.svelte';
import { chooseLanguage } from './lib/i18n';

document.documentElement.lang = chooseLanguage(navigator.languages);
mount(App, { target: document.getElementById('app')! });
